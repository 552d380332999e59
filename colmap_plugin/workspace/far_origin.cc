#include "colmap_plugin/workspace/far_origin.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace hpm {
namespace {

// In pixels, between neighbouring float32 positions at the depth of the scene.
constexpr double kTooCoarse = 0.5;

double StepInPixels(const Workspace& workspace, const StereoProblem& problem) {
  const Camera& camera = workspace.camera(problem.ref_image);
  const double step = std::numeric_limits<float>::epsilon() *
                      workspace.Center(problem.ref_image).norm();
  const double depth = std::sqrt(static_cast<double>(problem.depth_min) *
                                 static_cast<double>(problem.depth_max));
  return step * std::max(camera.fx, camera.fy) / depth;
}

}  // namespace

void WarnOfFarOrigin(const Workspace& workspace,
                     const std::vector<StereoProblem>& problems,
                     const LogSink& log) {
  const auto coarsest = std::max_element(
      problems.begin(),
      problems.end(),
      [&](const StereoProblem& a, const StereoProblem& b) {
        return StepInPixels(workspace, a) < StepInPixels(workspace, b);
      });
  if (!log || coarsest == problems.end()) return;
  const double step = StepInPixels(workspace, *coarsest);
  if (!(step > kTooCoarse)) return;
  const Eigen::Vector3d& center = workspace.Center(coarsest->ref_image);
  log(LogLevel::kWarning,
      fmt::format(
          "The cameras lie far from the model's origin ({} at {:.0f} {:.0f} "
          "{:.0f}): the maps do not suffer, but COLMAP's stereo_fusion and PLY "
          "files hold positions as 32-bit numbers, {:.1f} pixels apart there, "
          "and lose points; move the sparse model to its origin before fusion "
          "(colmap model_aligner, or subtract that position)",
          workspace.ImageName(coarsest->ref_image),
          center.x(),
          center.y(),
          center.z(),
          step));
}

}  // namespace hpm
