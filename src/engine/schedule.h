// Methods as data: the passes of each preset.
#pragma once

#include <string>
#include <vector>

#include "src/core/checkerboard.h"
#include "src/engine/pass.h"

namespace hpm {

struct ScheduleOptions {
  std::string method = "hpm";
  int num_iterations = 3;       // of basic and prior passes
  int num_geom_iterations = 3;  // of geometric passes
  int num_geom_passes = 2;
};

struct Schedule {
  SamplingPattern pattern;
  std::vector<Pass> photometric;  // per image, independent of other images
  std::vector<Pass> geometric;    // each reads the maps of the pass before, of all images
};

// Names of all methods, for messages and help.
std::vector<std::string> MethodNames();

// Throws Error(kUsage) for an unknown method.
Schedule MakeSchedule(const ScheduleOptions& options);

}  // namespace hpm
