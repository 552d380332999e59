// Methods as data: stages of passes.
#pragma once

#include "src/core/checkerboard.h"
#include "src/engine/pass.h"

#include <string>
#include <vector>

namespace hpm {

enum class HalfSearch { kAuto, kOff, kOn };

struct ScheduleOptions {
  std::string method = "hpm";
  int num_iterations = 2;       // of basic and prior passes
  int num_geom_iterations = 1;  // of geometric passes
  int num_geom_passes = 3;      // 0: photometric only
  int num_levels = 1;           // of the prior hierarchy or the image pyramid
  // With region priors, in place of num_iterations and num_geom_passes at
  // levels finer than the coarsest.
  int num_fine_iterations = 0;
  int num_fine_geom_passes = 1;
  // hpm and hpm_fast mine planes of regions (src/engine/mine_regions.h) at
  // every level of the images; else triangles of credible points as the paper
  // does. All geometric passes but the last of a level visit half the pixels.
  // hpm_fast takes half the geometric passes, which all visit half the pixels,
  // one iteration less at the coarsest level and none at finer ones.
  bool region_priors = true;
  // With region priors: the iterations of the coarsest level, and one more,
  // run at half its size. kAuto: in hpm_fast, and where there is one level.
  HalfSearch half_search = HalfSearch::kAuto;
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

// Names of all methods, for messages and help.
std::vector<std::string> MethodNames();

// Throws Error(kUsage) for an unknown method.
Schedule MakeSchedule(const ScheduleOptions& options);

// Halvings of an image whose longer side is `side` pixels until at most 500
// are left, plus one: measured (docs/ablation.md).
int AutomaticLevels(int side);

}  // namespace hpm
