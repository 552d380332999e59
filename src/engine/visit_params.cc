#include "src/engine/visit_params.h"

#include <algorithm>

namespace hpm {

float Parallax(const View& ref, const View& src) {
  const Vec3f baseline =
      src.camera.R * (Center(ref.camera) - Center(src.camera));
  return std::max(src.camera.fx, src.camera.fy) * Norm(baseline);
}

float Parallax(const ViewSet& views) {
  float parallax = 0;
  for (const View& src : views.srcs)
    parallax = std::max(parallax, Parallax(views.ref, src));
  return parallax;
}

float MedianParallax(const ViewSet& views) {
  std::vector<float> all;
  for (const View& src : views.srcs) {
    const float parallax = Parallax(views.ref, src);
    if (parallax > 0) all.push_back(parallax);
  }
  if (all.empty()) return 0;
  const auto middle = all.begin() + static_cast<ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

PatchShape ShapeOf(const MethodParams& params) {
  return MakePatchShape(params.patch_radius,
                        params.sigma_spatial,
                        params.sigma_color,
                        params.cut_color);
}

VisitParams MakeVisitParams(const ViewSet& views, const MethodParams& params) {
  VisitParams visit = {};
  visit.ref = views.ref.camera;
  visit.num_views = static_cast<int>(views.srcs.size());
  visit.depth_min = views.depth_min;
  visit.depth_max = views.depth_max;
  visit.num_view_draws = params.num_view_draws;
  visit.max_views = params.max_views;
  visit.depth_perturbation = params.depth_perturbation;
  visit.normal_perturbation = params.normal_perturbation;
  visit.same_plane_bound = params.same_plane_bound;
  visit.worst_cost = params.worst_cost;
  visit.parallax = Parallax(views);
  visit.patch_radius = params.patch_radius;
  visit.geometric_term = {params.geom_weight, params.geom_max_error};
  visit.prior_term = {
      params.prior_gamma,
      params.prior_beta,
      params.prior_depth_share * (views.depth_max - views.depth_min),
      params.prior_angle};
  return visit;
}

VisitParams ForPass(VisitParams visit,
                    const MethodParams& params,
                    const Pass& pass) {
  visit.geometric = pass.kind == PassKind::kGeometric;
  visit.search_near = pass.search_near;
  visit.ask_all_views = pass.ask_all_views;
  visit.few_views = pass.few_views;
  visit.max_candidates = pass.max_candidates;
  visit.max_views = std::min(visit.max_views, pass.max_views);
  if (pass.regions == RegionPriors::kStrong)
    visit.prior_term.gamma = params.region_gamma;
  return visit;
}

}  // namespace hpm
