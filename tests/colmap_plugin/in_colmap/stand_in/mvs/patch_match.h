// What the glue needs of COLMAP 3.8's header of this name.
#pragma once

#include "colmap_plugin/options/options.h"

namespace colmap {
namespace mvs {

struct PatchMatchOptions : hpm::PatchMatchStereoOptions {
  int max_image_size = -1;
  double depth_min = -1, depth_max = -1;
  double min_triangulation_angle = 1;
};

}  // namespace mvs
}  // namespace colmap
