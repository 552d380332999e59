#include "colmap_plugin/controller/stage_fingerprint.h"

#include "colmap_plugin/options/option_fingerprint.h"
#include "colmap_plugin/workspace/source_level.h"

#include <cstdint>
#include <type_traits>

namespace hpm {
namespace {

// Raise when the same options give other maps.
constexpr int kAlgorithmVersion = 21;

// The pose as the reference sees it.
void AddImage(const Workspace& workspace,
              const ImageContents& contents,
              int image,
              int ref_image,
              Fingerprint* hash) {
  const Camera camera = workspace.CameraAround(image, ref_image);
  hash->AddString(workspace.ImageName(image)).AddString(contents.HashOf(image));
  hash->AddInt(camera.width).AddInt(camera.height);
  for (const float v : {camera.fx, camera.fy, camera.cx, camera.cy})
    hash->AddDouble(v);
  for (const float v : camera.R.m) hash->AddDouble(v);
  for (const float v : {camera.t.x, camera.t.y, camera.t.z}) hash->AddDouble(v);
  const ImageDecoding decoding = workspace.Decoding(image);
  if (decoding.stretch) {
    hash->AddString("stretched")
        .AddDouble(decoding.stretch->low)
        .AddDouble(decoding.stretch->high);
  }
  if (decoding.reduction > 1)
    hash->AddString("decoded at").AddInt(decoding.reduction);
}

template <class... Values>
void AddAll(Fingerprint* hash, const Values&... values) {
  const auto add = [hash](auto value) {
    if constexpr (std::is_floating_point_v<decltype(value)>) {
      hash->AddDouble(value);
    } else {
      hash->AddInt(static_cast<int64_t>(value));
    }
  };
  (add(values), ...);
}

}  // namespace

// A new member breaks the line: then it is added to both lists, here and in the
// test, and no map is taken for one made with another number.
void AddToFingerprint(const MethodParams& params, Fingerprint* hash) {
  const auto& [patch_radius,
               sigma_spatial,
               sigma_color,
               cut_color,
               num_view_draws,
               max_views,
               depth_perturbation,
               normal_perturbation,
               same_plane_bound,
               worst_cost,
               geom_weight,
               geom_max_error,
               prior_gamma,
               prior_beta,
               prior_depth_share,
               prior_angle,
               weak_gradient,
               region_min_share,
               region_max_error,
               region_max_residual,
               region_min_consistent,
               region_gamma] = params;
  AddAll(hash,
         patch_radius,
         sigma_spatial,
         sigma_color,
         cut_color,
         num_view_draws,
         max_views,
         depth_perturbation,
         normal_perturbation,
         same_plane_bound,
         worst_cost,
         geom_weight,
         geom_max_error,
         prior_gamma,
         prior_beta,
         prior_depth_share,
         prior_angle,
         weak_gradient,
         region_min_share,
         region_max_error,
         region_max_residual,
         region_min_consistent,
         region_gamma);
}

void AddToFingerprint(const Pass& pass, Fingerprint* hash) {
  const auto& [kind,
               start,
               num_iterations,
               id,
               level,
               median,
               regions,
               triangles,
               ask_all_views,
               search_near,
               max_candidates,
               max_views,
               few_views,
               half_visits,
               rest_plain,
               propagate_views,
               fit_planes] = pass;
  AddAll(hash,
         kind,
         start,
         num_iterations,
         id,
         level,
         median,
         regions,
         triangles,
         ask_all_views,
         search_near,
         max_candidates,
         max_views,
         few_views,
         half_visits,
         rest_plain,
         propagate_views,
         fit_planes);
}

std::string FingerprintOfStage(const std::string& name,
                               const StageSpec& stage,
                               bool is_final,
                               const ControllerOptions& options) {
  Fingerprint hash;
  hash.AddInt(kAlgorithmVersion).AddString(name);
  hash.AddInt(stage.from_coarser).AddInt(is_final);
  AddToFingerprint(DefaultParams(FindMethod(options.hpm.method)), &hash);
  for (const Pass& pass : stage.passes) AddToFingerprint(pass, &hash);
  AddOptions(options, stage, is_final, &hash);
  return hash.Hex();
}

std::string OwnFingerprint(const Workspace& workspace,
                           const ImageContents& contents,
                           const StereoProblem& problem,
                           bool is_final,
                           const std::string& fingerprint_of_stage) {
  Fingerprint hash;
  hash.AddString(fingerprint_of_stage);
  AddImage(workspace, contents, problem.ref_image, problem.ref_image, &hash);
  for (const int src : problem.src_images) {
    AddImage(workspace, contents, src, problem.ref_image, &hash);
    const int level = SourceLevel(workspace, problem, src);
    if (level > 0) hash.AddString("halved").AddInt(level);
  }
  hash.AddDouble(problem.depth_min).AddDouble(problem.depth_max);
  if (is_final)
    hash.AddDouble(problem.published.min).AddDouble(problem.published.max);
  return hash.Hex();
}

}  // namespace hpm
