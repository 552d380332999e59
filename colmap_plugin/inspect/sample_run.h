// How fast this machine is at the work of a run: a short run of one image.
#pragma once

#include "colmap_plugin/inspect/planned_run.h"

#include <optional>
#include <string>

namespace hpm {

struct Sample {
  double work_per_second = 0;  // see PlannedRun::Work()
  double seconds = 0;          // measured, without planning
  std::string image;
  int max_image_size = 0;
};

// Computes an image of middling many sources at a reduced size, twice, for
// about so many seconds together, in which reading the workspace does not
// count; where that is not enough to see anything, or the image fails, nothing.
// The maps are thrown away. Throws Error(kInterrupted).
std::optional<Sample> MeasureSample(const PlannedRun& run,
                                    double seconds,
                                    const CancelToken& cancel);

}  // namespace hpm
