#include "colmap_plugin/options/method_options.h"

#include "colmap_plugin/options/effective_options.h"

namespace hpm {

MethodParams MakeMethodParams(const ControllerOptions& given) {
  const ControllerOptions options = EffectiveOptions(given);
  const PatchMatchStereoOptions& colmap = options.patch_match;
  const HpmOptions& hpm = options.hpm;
  MethodParams params = DefaultParams(FindMethod(hpm.method));
  params.patch_radius = colmap.window_radius;
  params.sigma_spatial = static_cast<float>(colmap.sigma_spatial);
  params.num_view_draws = colmap.num_samples;
  params.geom_weight = static_cast<float>(hpm.geom_weight);
  params.geom_max_error = static_cast<float>(hpm.geom_max_error);
  params.max_views = hpm.max_views;
  params.weak_gradient = static_cast<float>(hpm.weak_gradient);
  return params;
}

ScheduleOptions MakeScheduleOptions(const ControllerOptions& given) {
  const HpmOptions hpm = EffectiveOptions(given).hpm;
  ScheduleOptions schedule;
  schedule.method = hpm.method;
  schedule.num_iterations = hpm.num_iterations;
  schedule.num_geom_iterations = hpm.num_geom_iterations;
  schedule.num_geom_passes =
      given.patch_match.geom_consistency ? hpm.num_geom_passes : 0;
  schedule.num_levels = hpm.num_levels;
  schedule.num_fine_iterations = hpm.num_fine_iterations;
  schedule.num_fine_geom_passes = hpm.num_fine_geom_passes;
  return schedule;
}

std::optional<MapFilter> MakeMapFilter(const ControllerOptions& options) {
  constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;
  const PatchMatchStereoOptions& colmap = options.patch_match;
  if (!colmap.filter && !options.hpm.confidence) return std::nullopt;
  MapFilter filter;
  filter.params = {static_cast<float>(colmap.filter_min_ncc),
                   static_cast<float>(colmap.filter_min_triangulation_angle *
                                      kRadiansPerDegree),
                   static_cast<float>(colmap.filter_geom_consistency_max_cost),
                   colmap.filter_min_num_consistent};
  filter.min_agreement = options.hpm.filter_min_agreement;
  filter.drops = colmap.filter;
  filter.rates = options.hpm.confidence;
  return filter;
}

}  // namespace hpm
