#include "colmap_plugin/controller/run_warnings.h"

#include "colmap_plugin/formats/published_file.h"
#include "colmap_plugin/workspace/image_files.h"

#include <set>

namespace hpm {

void WarnOfChangedImages(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const ImageContents& contents,
                         const LogSink& log) {
  std::set<int> images;
  for (const StereoProblem& problem : problems) {
    if (!CanBeComputed(workspace, problem)) continue;
    images.insert(problem.ref_image);
    images.insert(problem.src_images.begin(), problem.src_images.end());
  }
  ImageFault changed;
  for (const int image : images) {
    if (!contents.IsUnchanged(image))
      changed.Add(workspace.ImagePath(image).string());
  }
  if (changed.num() == 0) return;
  log(LogLevel::kWarning,
      changed.Line(static_cast<int>(problems.size()),
                   "changed during this run") +
          "; run again, which makes anew what was made from them");
}

void WarnOfOldMaps(const Workspace& workspace,
                   const std::vector<StereoProblem>& problems,
                   const StagePlan& plan,
                   const LogSink& log) {
  const int last = static_cast<int>(plan.stages().size()) - 1;
  ImageFault old;
  int num_references = 0;
  for (const StereoProblem& problem : problems) {
    num_references += problem.is_reference;
    if (!problem.is_reference || CanBeComputed(workspace, problem)) continue;
    if (StateOf(plan.Files(last, problem.ref_image).depth))
      old.Add(workspace.ImageName(problem.ref_image));
  }
  if (old.num() == 0) return;
  log(LogLevel::kWarning,
      old.Line(num_references,
               "that cannot be computed have maps of an earlier run, which "
               "stereo_fusion would use") +
          "; mend the images and run again, or delete these maps");
}

void WarnOfEmptyMaps(const std::map<std::string, double>& valid_shares,
                     const std::map<std::string, FilterLosses>& losses,
                     const LogSink& log) {
  constexpr double kNextToNothing = 0.01;
  ImageFault empty;
  for (const auto& [image, share] : valid_shares) {
    const auto found = losses.find(image);
    const bool is_told =
        found != losses.end() && !FilterWarnings({*found}, {}).empty();
    if (share < kNextToNothing && !is_told) empty.Add(image);
  }
  if (empty.num() == 0) return;
  log(LogLevel::kWarning,
      empty.Line(static_cast<int>(valid_shares.size()),
                 "have a depth at less than 1 % of their pixels") +
          "; look at their masks, at depth ranges given by hand, and in the "
          "report at what dropped them");
}

}  // namespace hpm
