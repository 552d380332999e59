#include "colmap_plugin/options/option_fingerprint.h"

#include "colmap_plugin/options/effective_options.h"
#include "colmap_plugin/options/option_table.h"

#include <filesystem>
#include <string>

namespace hpm {
namespace {

bool IsConcerned(Concerns concerns, const StageSpec& stage, bool is_final) {
  switch (concerns) {
    case Concerns::kAllStages:
      return true;
    case Concerns::kGeometricStages:
      return stage.geometric;
    case Concerns::kFinalStage:
      return is_final;
    case Concerns::kPasses:
    case Concerns::kInputs:
    case Concerns::kOtherOptions:
    case Concerns::kRounding:
    case Concerns::kNothing:
      break;
  }
  return false;
}

struct AddValue {
  Fingerprint* hash;

  void operator()(const bool* value) const { hash->AddInt(*value); }
  void operator()(const int* value) const { hash->AddInt(*value); }
  void operator()(const double* value) const { hash->AddDouble(*value); }
  void operator()(const std::string* value) const { hash->AddString(*value); }
  void operator()(const std::filesystem::path* value) const {
    hash->AddString(value->string());
  }
};

}  // namespace

void AddOptions(const ControllerOptions& options,
                const StageSpec& stage,
                bool is_final,
                Fingerprint* hash) {
  ToolOptions effective;
  effective.controller = EffectiveOptions(options);
  for (const OptionSpec& option : OptionTable()) {
    if (!IsConcerned(option.concerns, stage, is_final)) continue;
    hash->AddString(option.name);
    std::visit(AddValue{hash}, option.member(&effective));
  }
}

}  // namespace hpm
