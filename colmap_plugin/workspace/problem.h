// What has to be solved: reference images, their sources and depth ranges.
#pragma once

#include "colmap_plugin/workspace/workspace.h"

#include <filesystem>
#include <vector>

namespace hpm {

struct StereoProblem {
  int ref_image = -1;           // image index
  std::vector<int> src_images;  // image indices, best first, without repeats
                                // and without ref_image
  float depth_min = 0;          // model units, see DepthRanges
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

// In file order, one problem per reference (a repeated reference keeps its
// first entry). Images without any source or of unknown depth range are skipped
// with a warning, and another one says if fusion will find nothing in common
// between the images. Throws Error(kBadInput) naming cfg file and line, or if
// nothing is left to do.
std::vector<StereoProblem> ReadProblems(const Workspace& workspace,
                                        const ProblemOptions& options,
                                        const LogSink& log);

}  // namespace hpm
