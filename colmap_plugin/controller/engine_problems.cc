#include "colmap_plugin/controller/engine_problems.h"

#include "colmap_plugin/workspace/source_level.h"
#include "src/core/rng.h"

#include <string>

namespace hpm {
namespace {

// Hypotheses may leave the range that is searched by this much, as in the
// paper's authors' code.
constexpr float kDepthMinSlack = 0.6f;
constexpr float kDepthMaxSlack = 1.2f;

// By name, so that the order of the images in the model does not matter.
uint64_t RandomKey(int seed, const std::string& image_name) {
  uint64_t key = static_cast<uint64_t>(seed);
  for (const char c : image_name) {
    key = CombineBits(key, static_cast<unsigned char>(c));
  }
  return key;
}

}  // namespace

std::vector<Problem> EngineProblems(const Workspace& workspace,
                                    const std::vector<StereoProblem>& problems,
                                    int random_seed) {
  std::vector<Problem> result;
  for (const StereoProblem& p : problems) {
    Problem problem;
    problem.image = p.ref_image;
    problem.camera = workspace.camera(p.ref_image);
    problem.depth_min = kDepthMinSlack * p.depth_min;
    problem.depth_max = kDepthMaxSlack * p.depth_max;
    problem.random_key =
        RandomKey(random_seed, workspace.ImageName(p.ref_image));
    if (CanBeComputed(workspace, p)) {
      for (const int src : p.src_images) {
        problem.sources.push_back({src,
                                   workspace.CameraAround(src, p.ref_image),
                                   SourceLevel(workspace, p, src)});
      }
    }
    result.push_back(std::move(problem));
  }
  return result;
}

}  // namespace hpm
