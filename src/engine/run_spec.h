// All that says what a run computes, but for the pictures.
#pragma once

#include "src/core/consistency_filter.h"
#include "src/engine/problem.h"
#include "src/engine/schedule.h"

#include <optional>
#include <string>
#include <vector>

namespace hpm {

// Of the maps of the last stage.
struct MapFilter {
  // Of fewer sources than min_num_consistent all must confirm a pixel.
  FilterParams params;
  double min_agreement = 0.5;  // see needed_views.h
  bool drops = true;           // false: all pixels stay
  bool rates = false;          // tells the confidence in each pixel
};

struct RunSpec {
  Schedule schedule;
  MethodParams params;
  std::optional<MapFilter>
      filter;  // none: all pixels stay, and nothing is asked
  std::vector<Problem> problems;
};

// Of a method as it stands in its row (src/engine/method.h), without problems
// and without filter; `side`: the longer one of the largest image, pixels.
// Throws Error(kUsage) for an unknown method.
RunSpec DefaultRunSpec(const std::string& method, int side);

}  // namespace hpm
