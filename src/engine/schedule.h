// Methods as data: the passes of each preset.
#pragma once

#include "src/core/checkerboard.h"
#include "src/engine/pass.h"

#include <string>
#include <vector>

namespace hpm {

struct ScheduleOptions {
  std::string method = "hpm";
  int num_iterations = 3;       // of basic and prior passes
  int num_geom_iterations = 3;  // of geometric passes
  int num_geom_passes = 2;
  int num_levels = -1;  // of the prior hierarchy; -1: by image size
};

struct Schedule {
  SamplingPattern pattern;
  std::vector<Pass> photometric;  // per image, independent of other images
  std::vector<Pass>
      geometric;  // each reads the maps of the pass before, of all images
};

// Names of all methods, for messages and help.
std::vector<std::string> MethodNames();

// For images of this size. Throws Error(kUsage) for an unknown method.
Schedule MakeSchedule(const ScheduleOptions& options, int width, int height);

}  // namespace hpm
