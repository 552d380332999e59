// What has to be solved: reference images, their sources and depth ranges.
#pragma once

#include "colmap_plugin/workspace/depth_range.h"
#include "src/base/cancel.h"

#include <filesystem>
#include <limits>
#include <vector>

namespace hpm {

class ModelOverview;

struct StereoProblem {
  int ref_image = -1;           // image index
  std::vector<int> src_images;  // image indices, best first, without repeats
                                // and without ref_image; all have a picture
  // To search, model units; see DepthRanges.
  float depth_min = 0;
  float depth_max = 0;
  // Depths outside are not published.
  DepthRange published = {0, std::numeric_limits<float>::infinity()};
  // False: only a source of references, see SourceProblems(). Its maps are for
  // other problems and not published.
  bool is_reference = true;
  // The sources it would have if all images had a picture. Which have one may
  // be known to some processes only; these are the same for all that share a
  // run.
  std::vector<int> wanted_sources = {};
  // Whether the reference shares tracks of sparse points with another image:
  // stereo_fusion joins no others.
  bool shares_points = true;
};

struct ProblemOptions {
  std::filesystem::path config_path;  // empty: the workspace's patch-match.cfg
  double depth_min = -1;              // both negative: automatic
  double depth_max = -1;
  std::filesystem::path depth_ranges;  // see given_ranges.h; empty: none
  double min_triangulation_angle = 1;  // degrees
  int max_num_src_images =
      32;  // view masks have 32 bits; more are cut with a note
};

// Whether there are pictures to compute it from.
bool CanBeComputed(const Workspace& workspace, const StereoProblem& problem);

// In file order, one problem per reference (a repeated reference keeps its
// first entry). Images without any source or of unknown depth range are skipped
// with a warning, and another one says if fusion will find nothing in common
// between the images; those that have no picture, or whose sources all have
// none (src_images is empty then), are kept, as problems that fail. Several
// threads choose the sources. Throws Error(kBadInput) naming cfg file and line,
// or if nothing is left to do, Error(kInterrupted).
// overview: of this workspace, made with the depths of `options`.
std::vector<StereoProblem> ReadProblems(const Workspace& workspace,
                                        const ModelOverview& overview,
                                        const ProblemOptions& options,
                                        const LogSink& log,
                                        const CancelToken& cancel);
// For those who ask once.
std::vector<StereoProblem> ReadProblems(const Workspace& workspace,
                                        const ProblemOptions& options,
                                        const LogSink& log);

}  // namespace hpm
