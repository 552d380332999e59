#include "colmap_plugin/workspace/source_problems.h"

#include "colmap_plugin/workspace/model_overview.h"
#include "colmap_plugin/workspace/planning_progress.h"

#include <algorithm>
#include <map>
#include <utility>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// COLMAP's own number in patch-match.cfg.
constexpr int kMaxNumSources = 20;

// Of an image whose own range nothing tells: that of the images which see the
// same.
DepthRange RangeOf(const std::vector<const StereoProblem*>& listed_by) {
  DepthRange range = {listed_by.front()->depth_min,
                      listed_by.front()->depth_max};
  for (const StereoProblem* problem : listed_by) {
    range.min = std::min(range.min, problem->depth_min);
    range.max = std::max(range.max, problem->depth_max);
  }
  return range;
}

}  // namespace

std::vector<StereoProblem> SourceProblems(
    const Workspace& workspace,
    const ModelOverview& overview,
    const std::vector<StereoProblem>& problems,
    const ProblemOptions& options,
    const LogSink& log,
    const CancelToken& cancel) {
  std::map<int, std::vector<const StereoProblem*>> listed_by;
  for (const StereoProblem& problem : problems) {
    if (!CanBeComputed(workspace, problem)) continue;
    for (const int src : problem.src_images) listed_by[src].push_back(&problem);
  }
  for (const StereoProblem& problem : problems)
    listed_by.erase(problem.ref_image);
  if (listed_by.empty()) return {};

  const auto max_num = static_cast<size_t>(
      std::clamp(options.max_num_src_images, 0, kMaxNumSources));
  const std::vector<std::pair<int, std::vector<const StereoProblem*>>> sources(
      listed_by.begin(), listed_by.end());
  std::vector<int> images;
  images.reserve(sources.size());
  for (const auto& [image, references] : sources) images.push_back(image);
  const std::vector<std::vector<SourceCandidate>> sharing =
      overview.automatic().Sharing(
          images, options.min_triangulation_angle, [] {});
  std::vector<StereoProblem> result(sources.size());
  PlanningProgress progress(
      "Choosing sources of source images", sources.size(), log, cancel);
  tbb::parallel_for(size_t{0}, sources.size(), [&](size_t i) {
    const auto& [image, references] = sources[i];
    StereoProblem& problem = result[i];
    problem.ref_image = image;
    problem.is_reference = false;
    const DepthRange range =
        overview.ranges().ForImage(image).value_or(RangeOf(references));
    problem.src_images = overview.automatic().Best(
        image, sharing[i], range, options.min_triangulation_angle, max_num);
    TakeThoseWithPictures(workspace, max_num, &problem.src_images);
    if (problem.src_images.empty()) {
      for (const StereoProblem* reference : references)
        problem.src_images.push_back(reference->ref_image);
      TakeThoseWithPictures(workspace, max_num, &problem.src_images);
    }
    problem.wanted_sources = problem.src_images;
    problem.depth_min = range.min;
    problem.depth_max = range.max;
    progress.Count();
  });
  return result;
}

}  // namespace hpm
