// COLMAP's options struct as ours: the same names, and the options that only
// some versions have.
#pragma once

#include "colmap_plugin/options/options.h"

#include <filesystem>
#include <string>

namespace hpm {
namespace in_colmap {

// -1 before 4.0, where COLMAP has no such option.
template <class ColmapOptions>
auto NumThreads(const ColmapOptions& options, int)
    -> decltype(options.num_threads) {
  return options.num_threads;
}
template <class ColmapOptions>
int NumThreads(const ColmapOptions&, long) {
  return -1;
}

// `ColmapOptions` is colmap::mvs::PatchMatchOptions of any version.
template <class ColmapOptions>
ControllerOptions ConvertOptions(const ColmapOptions& from,
                                 const std::filesystem::path& workspace_path,
                                 const std::string& workspace_format,
                                 const std::string& pmvs_option_name,
                                 const std::filesystem::path& config_path,
                                 int random_seed) {
  ControllerOptions to;
  to.workspace.path = workspace_path;
  to.workspace.format = workspace_format;
  to.workspace.pmvs_option_name = pmvs_option_name;
  to.problems.config_path = config_path;
  to.random_seed = random_seed;

  to.workspace.max_image_size = from.max_image_size;
  to.problems.depth_min = from.depth_min;
  to.problems.depth_max = from.depth_max;
  to.problems.min_triangulation_angle = from.min_triangulation_angle;

  PatchMatchStereoOptions& stereo = to.patch_match;
  stereo.gpu_index = from.gpu_index;
  stereo.window_radius = from.window_radius;
  stereo.window_step = from.window_step;
  stereo.sigma_spatial = from.sigma_spatial;
  stereo.sigma_color = from.sigma_color;
  stereo.num_samples = from.num_samples;
  stereo.ncc_sigma = from.ncc_sigma;
  stereo.incident_angle_sigma = from.incident_angle_sigma;
  stereo.num_iterations = from.num_iterations;
  stereo.geom_consistency = from.geom_consistency;
  stereo.geom_consistency_regularizer = from.geom_consistency_regularizer;
  stereo.geom_consistency_max_cost = from.geom_consistency_max_cost;
  stereo.filter = from.filter;
  stereo.filter_min_ncc = from.filter_min_ncc;
  stereo.filter_min_triangulation_angle = from.filter_min_triangulation_angle;
  stereo.filter_min_num_consistent = from.filter_min_num_consistent;
  stereo.filter_geom_consistency_max_cost =
      from.filter_geom_consistency_max_cost;
  stereo.cache_size = from.cache_size;
  stereo.allow_missing_files = from.allow_missing_files;
  stereo.write_consistency_graph = from.write_consistency_graph;
  stereo.num_threads = NumThreads(from, 0);

  // As on our command line: COLMAP's defaults belong to COLMAP's cost, so these
  // count only when they were changed.
  const ColmapOptions defaults{};
  if (from.geom_consistency_regularizer !=
      defaults.geom_consistency_regularizer) {
    to.hpm.geom_weight = from.geom_consistency_regularizer;
  }
  if (from.geom_consistency_max_cost != defaults.geom_consistency_max_cost) {
    to.hpm.geom_max_error = from.geom_consistency_max_cost;
  }
  return to;
}

}  // namespace in_colmap
}  // namespace hpm
