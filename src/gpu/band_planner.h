// How many rows go into one launch, so that none lasts long: a desktop's
// watchdog ends launches of seconds, and a cancelled run should stop soon.
#pragma once

#include "src/core/sweep.h"

#include <array>

namespace hpm {

class BandPlanner {
 public:
  explicit BandPlanner(double target_seconds);

  // A multiple of the height of a tile, at most all rows that are left.
  int NextRows(SweepKind kind, int rows_left, int tile_height) const;

  // What a launch took. Bands at most quadruple from one report to the next.
  void Report(SweepKind kind, int num_rows, double seconds);

 private:
  double target_seconds_;
  std::array<double, kNumSweepKinds> rows_;  // per kind
};

}  // namespace hpm
