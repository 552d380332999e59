#include "colmap_plugin/controller/method_options.h"

namespace hpm {

MethodParams MakeMethodParams(const ControllerOptions& options) {
  const PatchMatchStereoOptions& colmap = options.patch_match;
  MethodParams params = DefaultParams(FindMethod(options.hpm.method));
  params.patch_radius = colmap.window_radius;
  params.sigma_spatial = static_cast<float>(
      colmap.sigma_spatial > 0 ? colmap.sigma_spatial
                               : static_cast<double>(colmap.window_radius));
  params.num_view_draws = colmap.num_samples;
  params.geom_weight = static_cast<float>(options.hpm.geom_weight);
  params.geom_max_error = static_cast<float>(options.hpm.geom_max_error);
  if (options.hpm.max_views > 0) params.max_drawn_views = options.hpm.max_views;
  params.region_max_gradient = static_cast<float>(options.hpm.weak_gradient);
  return params;
}

ScheduleOptions MakeScheduleOptions(const ControllerOptions& options) {
  const HpmOptions& hpm = options.hpm;
  const auto own_if_none = [](int given) { return given > 0 ? given : -1; };
  ScheduleOptions schedule;
  schedule.method = hpm.method;
  schedule.num_iterations = own_if_none(hpm.num_iterations);
  schedule.num_geom_iterations = own_if_none(hpm.num_geom_iterations);
  schedule.num_geom_passes = options.patch_match.geom_consistency
                                 ? own_if_none(hpm.num_geom_passes)
                                 : 0;
  schedule.num_levels = hpm.num_levels;
  schedule.num_fine_iterations = hpm.num_fine_iterations;
  schedule.num_fine_geom_passes = own_if_none(hpm.num_fine_geom_passes);
  return schedule;
}

std::optional<MapFilter> MakeMapFilter(const ControllerOptions& options) {
  constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;
  const PatchMatchStereoOptions& colmap = options.patch_match;
  if (!colmap.filter) return std::nullopt;
  MapFilter filter;
  filter.params = {static_cast<float>(colmap.filter_min_ncc),
                   static_cast<float>(colmap.filter_min_triangulation_angle *
                                      kRadiansPerDegree),
                   static_cast<float>(colmap.filter_geom_consistency_max_cost),
                   colmap.filter_min_num_consistent};
  filter.min_agreement = options.hpm.filter_min_agreement;
  return filter;
}

}  // namespace hpm
