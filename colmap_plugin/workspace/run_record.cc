#include "colmap_plugin/workspace/run_record.h"

#include "colmap_plugin/formats/atomic_file.h"

namespace hpm {

void WriteRunRecord(const std::filesystem::path& state_path,
                    const std::string& name,
                    const nlohmann::json& record) {
  // Image names are bytes, not always UTF-8; a record must not fail on that.
  const std::string text =
      record.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
      "\n";
  WriteFileAtomically(state_path / name, text);
}

}  // namespace hpm
