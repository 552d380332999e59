// Grammar of patch-match.cfg and fusion.cfg, as COLMAP reads them:
//   lines trimmed of blank, tab and CR; empty lines and lines that begin with
//   '#' dropped; then pairs of a reference line (taken whole) and a source
//   line:
//   "__all__" | "__auto__" sep N | name { sep name }, sep = any run of ',' and
//   ';'.
// A word list that only looks like a keyword ("__auto__" alone, "__all__, x")
// is a list of names. N is its leading integer, the rest of the word is
// ignored.
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
  std::vector<std::string>
      src_names;  // kList, in file order, may repeat or be empty
  // 1-based, for messages.
  int line = 0;      // of the reference
  int src_line = 0;  // of its sources
};

struct PatchMatchCfgLine {
  std::string text;
  int line = 0;  // 1-based
};

struct PatchMatchCfg {
  std::vector<PatchMatchCfgEntry> entries;
  // What COLMAP drops without a word: lines that begin with '#', and a last
  // reference without source line (empty if there is none).
  std::vector<PatchMatchCfgLine> comments;
  PatchMatchCfgLine unpaired;
};

// A byte order mark is dropped (COLMAP would take it for a part of the first
// name). Throws Error(kBadInput) with file and line.
PatchMatchCfg ReadPatchMatchCfg(const std::filesystem::path& path);

// Both atomic; throw Error(kBadInput) for a name that the file cannot express.
void WritePatchMatchCfg(const std::filesystem::path& path,
                        const std::vector<PatchMatchCfgEntry>& entries);

// One image name per line.
void WriteFusionCfg(const std::filesystem::path& path,
                    const std::vector<std::string>& names);

}  // namespace hpm
