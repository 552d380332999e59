// What has to be solved: reference images, their sources and depth ranges.
#pragma once

#include "colmap_plugin/workspace/workspace.h"

#include <filesystem>
#include <vector>

namespace hpm {

struct StereoProblem {
  int ref_image = -1;           // image index
  std::vector<int> src_images;  // image indices, best first, without repeats
                                // and without ref_image; all have a picture
  float depth_min =
      0;  // model units, COLMAP's [0.75 P1, 1.25 P99] or as given by the user
  float depth_max = 0;
};

struct ProblemOptions {
  std::filesystem::path config_path;  // empty: the workspace's patch-match.cfg
  double depth_min = -1;              // both negative: automatic
  double depth_max = -1;
  double min_triangulation_angle = 1;  // degrees
  int max_num_src_images =
      32;  // view masks have 32 bits; more are cut with a note
};

// Whether there are pictures to compute it from.
bool CanBeComputed(const Workspace& workspace, const StereoProblem& problem);

// In file order, one problem per reference (a repeated reference keeps its
// first entry). Images without any source are skipped with COLMAP's warning;
// those that have no picture, or whose sources all have none (src_images is
// empty then), are kept, as problems that fail.
// Throws Error(kBadInput) naming cfg file and line.
std::vector<StereoProblem> ReadProblems(const Workspace& workspace,
                                        const ProblemOptions& options,
                                        const LogSink& log);

}  // namespace hpm
