// What people write into patch-match.cfg by hand that means something else than
// they think, and the form that is right.
#pragma once

#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/log.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hpm {

// What to do about a line, or an item of it, that names no image of the model.
std::string RemedyForName(const Workspace& workspace, const std::string& name);

// Throws Error(kBadInput) with file and line where COLMAP would drop images
// without a word (names that count as comments, a keyword or a list of names
// where pairs of lines belong); warns where that may be meant.
void CheckCfg(const Workspace& workspace,
              const std::filesystem::path& path,
              const PatchMatchCfg& cfg,
              const LogSink& log);

}  // namespace hpm
