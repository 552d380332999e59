// The criteria of the filter of finished maps, and shares of pixels lost to
// them.
#pragma once

#include <map>

namespace hpm {

// In the order in which a source must pass them.
enum class FilterCriterion {
  kFacing,         // the source looks at the back of the surface
  kAngle,          // the source sees it under too small an angle
  kGeometry,       // the source found another depth, or none
  kCorrelation,    // the images differ
  kNumConsistent,  // some sources confirm the pixel, too few
  // Enough do, but not half of those that see it, in a region without
  // texture that no plane explains.
  kUnexplained,
  kRange,  // confirmed, but outside the depth range given by hand
};

// Short, for the run record and the summary.
inline const char* NameOf(FilterCriterion criterion) {
  switch (criterion) {
    case FilterCriterion::kFacing:
      return "facing";
    case FilterCriterion::kAngle:
      return "angle";
    case FilterCriterion::kGeometry:
      return "geometry";
    case FilterCriterion::kCorrelation:
      return "correlation";
    case FilterCriterion::kNumConsistent:
      return "consistent views";
    case FilterCriterion::kUnexplained:
      return "unexplained";
    case FilterCriterion::kRange:
      break;
  }
  return "range";
}

// Share of an image's pixels, 0..1, per criterion that took any.
using FilterLosses = std::map<FilterCriterion, double>;

}  // namespace hpm
