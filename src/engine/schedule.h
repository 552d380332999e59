// A method as stages of passes.
#pragma once

#include "src/core/checkerboard.h"
#include "src/engine/method.h"

#include <string>
#include <vector>

namespace hpm {

// -1: as the method's row has it. The last stage has a pass at least.
struct ScheduleOptions {
  std::string method = kDefaultMethod;
  int num_iterations = -1;
  int num_geom_iterations = -1;
  int num_geom_passes = -1;  // 0: photometric only
  int num_levels = 1;        // of the prior hierarchy or the images
  int num_fine_iterations = -1;
  int num_fine_geom_passes = -1;
};

// What runs without looking at other images' results. Between stages lies a
// barrier over all images.
struct StageSpec {
  int level = 0;  // images and maps are halved this many times
  bool geometric =
      false;  // reads the maps of the stage before, of reference and sources
  bool from_coarser =
      false;  // starts from the maps of the stage before, upsampled
  std::vector<Pass> passes;
};

struct Schedule {
  SamplingPattern pattern;
  std::vector<StageSpec> stages;
};

// Throws Error(kUsage) for an unknown method.
Schedule MakeSchedule(const ScheduleOptions& options);

}  // namespace hpm
