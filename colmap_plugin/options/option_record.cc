#include "colmap_plugin/options/option_record.h"

#include "colmap_plugin/options/effective_options.h"
#include "colmap_plugin/options/option_table.h"

#include <filesystem>

namespace hpm {
namespace {

struct ToJsonValue {
  template <class T>
  nlohmann::json operator()(const T* value) const {
    return *value;
  }
  nlohmann::json operator()(const std::filesystem::path* value) const {
    return value->string();
  }
};

}  // namespace

nlohmann::json OptionRecord(const ControllerOptions& options) {
  ToolOptions effective;
  effective.controller = EffectiveOptions(options);
  nlohmann::json record = nlohmann::json::object();
  for (const OptionSpec& option : OptionTable()) {
    if (!option.no_effect.empty()) continue;
    record[option.name] = std::visit(ToJsonValue(), option.member(&effective));
  }
  return record;
}

}  // namespace hpm
