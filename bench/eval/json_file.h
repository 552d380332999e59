// Results as a JSON file.
#pragma once

#include "colmap_plugin/formats/atomic_file.h"

#include <string>

#include <nlohmann/json.hpp>

namespace hpm {

// Does nothing for an empty path.
inline void WriteJsonFile(const std::string& path, const nlohmann::json& json) {
  if (!path.empty()) WriteFileAtomically(path, json.dump(2) + "\n");
}

}  // namespace hpm
