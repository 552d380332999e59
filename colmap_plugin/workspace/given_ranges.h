// Depth ranges given by hand for single images.
#pragma once

#include "colmap_plugin/workspace/depth_range.h"

#include <filesystem>
#include <map>

namespace hpm {

// Lines "IMAGE NEAR FAR", NEAR and FAR in model units; the name may hold
// blanks; empty lines and those that begin with '#' do not count. Nothing for
// an empty path. Throws
// Error(kBadInput) with file and line for anything else: an image that the
// model does not have or that is named twice, or no range.
std::map<int, DepthRange> ReadGivenRanges(const Workspace& workspace,
                                          const std::filesystem::path& path);

}  // namespace hpm
