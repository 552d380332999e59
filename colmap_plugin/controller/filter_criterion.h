// The criteria of the filter of finished maps, what helps against them, and
// shares of pixels lost to them.
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

// What may bring pixels back that the criterion took: an order to the user.
inline const char* RemedyFor(FilterCriterion criterion) {
  switch (criterion) {
    case FilterCriterion::kFacing:
      return "take more images of this side; a depth that cannot be is dropped "
             "rightly";
    case FilterCriterion::kAngle:
      return "take images further apart, or lower "
             "--PatchMatchStereo.filter_min_triangulation_angle";
    case FilterCriterion::kGeometry:
      return "check poses and overlap, look for things that move, reflect or "
             "are seen by one image only, or raise "
             "--PatchMatchStereo.filter_geom_consistency_max_cost";
    case FilterCriterion::kCorrelation:
      return "look for mirrors, glass, shadows that moved and masked parts of "
             "sources, or lower --PatchMatchStereo.filter_min_ncc";
    case FilterCriterion::kNumConsistent:
      return "take more images, or lower "
             "--PatchMatchStereo.filter_min_num_consistent";
    case FilterCriterion::kUnexplained:
      return "--Hpm.filter_min_agreement 0 keeps more of them; a mask leaves "
             "them out";
    case FilterCriterion::kRange:
      break;
  }
  return "change --PatchMatchStereo.depth_min and "
         "--PatchMatchStereo.depth_max, or the image's line in "
         "--Hpm.depth_ranges";
}

// Share of an image's pixels, 0..1, per criterion that took any.
using FilterLosses = std::map<FilterCriterion, double>;

}  // namespace hpm
