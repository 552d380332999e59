// stereo/hpm_mvs/run.json: what the last run did, for people and scripts.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace hpm {

// Atomic. Throws as WriteFileAtomically does.
void WriteRunRecord(const std::filesystem::path& state_path,
                    const nlohmann::json& record);

}  // namespace hpm
