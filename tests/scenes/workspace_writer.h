// A test scene as a COLMAP dense workspace, as image_undistorter would leave
// it, with the truth beside it:
//   images/viewNN.png  sparse/*.bin  stereo/patch-match.cfg fusion.cfg (and
//   empty map folders)  gt/depth_maps/viewNN.png.bin
//   gt/normal_maps/viewNN.png.bin
#pragma once

#include "tests/scenes/render.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hpm {

std::string ViewName(int index);  // "view00.png", ...

// The sparse points lie on the surface, seen in at least two views, with exact
// tracks. Replaces files of the same names. Returns the views for further use.
std::vector<RenderedView> WriteWorkspace(const TestScene& scene,
                                         const std::filesystem::path& folder);

// The truth as finished maps stereo/{depth,normal}_maps/<name>.<stage>.bin, on
// the rays that COLMAP's map files mean.
void WriteTruthAsMaps(const TestScene& scene,
                      const std::filesystem::path& folder,
                      const std::string& stage);

}  // namespace hpm
