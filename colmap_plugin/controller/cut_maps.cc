#include "colmap_plugin/controller/cut_maps.h"

#include "colmap_plugin/controller/ray_convention.h"
#include "colmap_plugin/workspace/stamp.h"

#include <cmath>

namespace hpm {
namespace {

void CutMaps(const Workspace& workspace,
             const StagePlan& plan,
             int stage,
             int problem,
             const StereoProblem& p) {
  const StageFiles files = plan.Files(stage, p.ref_image);
  DepthAndNormal maps = {ReadMap(files.depth), ReadMap(files.normal)};
  DropOutside(p.published, &maps);
  const std::string& name = workspace.ImageName(p.ref_image);
  const std::string stage_name = plan.NameOf(stage, p.ref_image);
  // The graph stays.
  Stamp stamp =
      ReadStamp(workspace.StatePath(), name, stage_name).value_or(Stamp{});
  RemoveStamp(workspace.StatePath(), name, stage_name);
  stamp.fingerprint = plan.CutFingerprintOf(stage, problem);
  stamp.files["normal"] = WriteMap(files.normal, maps.normal);
  stamp.files["depth"] = WriteMap(files.depth, maps.depth);
  WriteStamp(workspace.StatePath(), name, stage_name, stamp);
}

}  // namespace

void CutInputMaps(const Workspace& workspace,
                  const std::vector<StereoProblem>& problems,
                  const StagePlan& plan,
                  const RunLock& lock,
                  const CancelToken& cancel) {
  for (int s = 0; s + 1 < static_cast<int>(plan.stages().size()); ++s) {
    for (int p = 0; p < static_cast<int>(problems.size()); ++p) {
      const int image = problems[p].ref_image;
      if (std::isfinite(problems[p].published.max) && plan.IsPublic(s, image) &&
          plan.HasCompleteMaps(s, image)) {
        cancel.ThrowIfCancelled();
        lock.ThrowIfLost();
        CutMaps(workspace, plan, s, p, problems[p]);
      }
    }
  }
}

}  // namespace hpm
