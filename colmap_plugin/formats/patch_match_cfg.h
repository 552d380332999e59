// Grammar of patch-match.cfg and fusion.cfg.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hpm {

struct PatchMatchCfgEntry {
  enum class Sources { kAll, kAuto, kList };
  std::string ref_name;
  Sources sources = Sources::kAuto;
  int max_num_auto = 0;  // kAuto: N of "__auto__, N"; negative = unlimited
  std::vector<std::string> src_names;  // kList, in file order, may repeat
  int line = 0;                        // 1-based line of the reference, for messages
};

// A trailing reference without source line is dropped, as COLMAP does.
// Throws Error(kBadInput) with file and line.
std::vector<PatchMatchCfgEntry> ReadPatchMatchCfg(const std::filesystem::path& path);

void WritePatchMatchCfg(const std::filesystem::path& path,
                        const std::vector<PatchMatchCfgEntry>& entries);

// One image name per line.
void WriteFusionCfg(const std::filesystem::path& path, const std::vector<std::string>& names);

}  // namespace hpm
