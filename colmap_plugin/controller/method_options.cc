#include "colmap_plugin/controller/method_options.h"

#include <algorithm>

namespace hpm {

MethodParams MakeMethodParams(const ControllerOptions& options) {
  const PatchMatchStereoOptions& colmap = options.patch_match;
  MethodParams params;
  params.patch_radius = colmap.window_radius;
  params.sigma_spatial = static_cast<float>(
      colmap.sigma_spatial > 0 ? colmap.sigma_spatial
                               : static_cast<double>(colmap.window_radius));
  params.num_view_draws = colmap.num_samples;
  params.geom_weight = static_cast<float>(options.hpm.geom_weight);
  params.geom_max_error = static_cast<float>(options.hpm.geom_max_error);
  params.max_drawn_views = options.hpm.max_views;
  params.region_max_gradient = static_cast<float>(options.hpm.weak_gradient);
  return params;
}

ScheduleOptions MakeScheduleOptions(const ControllerOptions& options) {
  return {
      options.hpm.method,
      options.hpm.num_iterations,
      options.hpm.num_geom_iterations,
      options.patch_match.geom_consistency ? options.hpm.num_geom_passes : 0,
      options.hpm.num_levels,
      options.hpm.num_fine_iterations,
      options.hpm.num_fine_geom_passes,
      options.hpm.prior == "regions",
      options.hpm.half_search < 0
          ? HalfSearch::kAuto
          : (options.hpm.half_search == 0 ? HalfSearch::kOff
                                          : HalfSearch::kOn)};
}

FilterParams MakeFilterParams(const PatchMatchStereoOptions& options,
                              int num_srcs) {
  constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;
  return {static_cast<float>(options.filter_min_ncc),
          static_cast<float>(options.filter_min_triangulation_angle *
                             kRadiansPerDegree),
          static_cast<float>(options.filter_geom_consistency_max_cost),
          std::min(options.filter_min_num_consistent, num_srcs)};
}

}  // namespace hpm
