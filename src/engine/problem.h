// What a run has to solve: a reference image, the images matched against it and
// the depths to search. Images have numbers; their pictures come from an
// ImageStore.
#pragma once

#include "src/core/camera.h"

#include <cstdint>
#include <vector>

namespace hpm {

struct ProblemSource {
  int image = 0;
  Camera camera;  // of the image at full size
  // The picture, its camera and its depth map are halved this many times more
  // than those of the reference: sources that show finer detail.
  int more_levels = 0;
};

// The cameras of a problem share one world frame. Its origin is best near the
// reference: single precision has no digits left for a pixel far from it.
struct Problem {
  int image = 0;
  Camera camera;                       // of the image at full size
  std::vector<ProblemSource> sources;  // at most kMaxViews
  // Hypotheses outside are not accepted, model units.
  float depth_min = 0, depth_max = 0;
  // Identifies the seed and the image: whoever wants the same maps again gives
  // the same key.
  uint64_t random_key = 0;
};

}  // namespace hpm
