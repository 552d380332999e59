#include "colmap_plugin/options/effective_options.h"

namespace hpm {

ControllerOptions EffectiveOptions(ControllerOptions options) {
  PatchMatchStereoOptions& colmap = options.patch_match;
  HpmOptions& hpm = options.hpm;
  const MethodNumbers& own = FindMethod(hpm.method).numbers;
  const auto own_if_none = [](int own_number, int* given) {
    if (*given <= 0) *given = own_number;
  };
  own_if_none(own.num_iterations, &hpm.num_iterations);
  own_if_none(own.num_geom_iterations, &hpm.num_geom_iterations);
  own_if_none(own.num_geom_passes, &hpm.num_geom_passes);
  own_if_none(own.num_fine_geom_passes, &hpm.num_fine_geom_passes);
  own_if_none(own.max_views, &hpm.max_views);
  if (hpm.num_fine_iterations < 0)  // 0: none
    hpm.num_fine_iterations = own.num_fine_iterations;
  if (!(colmap.sigma_spatial > 0)) colmap.sigma_spatial = colmap.window_radius;
  if (!colmap.filter) {
    const PatchMatchStereoOptions defaults;
    colmap.filter_min_ncc = defaults.filter_min_ncc;
    colmap.filter_min_triangulation_angle =
        defaults.filter_min_triangulation_angle;
    colmap.filter_min_num_consistent = defaults.filter_min_num_consistent;
    colmap.filter_geom_consistency_max_cost =
        defaults.filter_geom_consistency_max_cost;
    hpm.filter_min_agreement = HpmOptions().filter_min_agreement;
  }
  return options;
}

}  // namespace hpm
