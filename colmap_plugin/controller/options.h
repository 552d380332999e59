// Every option of the program, grouped as on the command line. One struct per
// prefix; the option table in colmap_plugin/tool maps names to these members.
#pragma once

#include "colmap_plugin/workspace/workspace.h"

#include <string>

namespace hpm {

// "--PatchMatchStereo.*": COLMAP's names, types and defaults (3.8 and 4.x).
// Options whose meaning does not exist in this method are accepted and named
// once in the log when they are set; see docs/options.md.
struct PatchMatchStereoOptions {
  int max_image_size = -1;
  std::string gpu_index = "-1";
  double depth_min = -1;
  double depth_max = -1;
  int window_radius = 5;
  int window_step = 1;
  double sigma_spatial = -1;
  double sigma_color = 0.2f;
  int num_samples = 15;
  double ncc_sigma = 0.6f;
  double min_triangulation_angle = 1;
  double incident_angle_sigma = 0.9f;
  int num_iterations = 5;
  bool geom_consistency = true;
  double geom_consistency_regularizer = 0.3f;
  double geom_consistency_max_cost = 3;
  bool filter = true;
  double filter_min_ncc = 0.1f;
  double filter_min_triangulation_angle = 3;
  int filter_min_num_consistent = 2;
  double filter_geom_consistency_max_cost = 1;
  double cache_size = 32;  // GiB
  bool allow_missing_files = false;
  bool write_consistency_graph = false;
  int num_threads = -1;
};

// "--Hpm.*": what COLMAP does not have.
struct HpmOptions {
  std::string method = "hpm_plus";  // see src/engine/method.h
  std::string quality = "high";     // see colmap_plugin/tool/quality.h
  std::string device = "auto";      // auto, cpu or cuda
  int gpu_images = -1;  // in flight per entry of gpu_index; -1: by memory
  std::string cpu_target =
      "auto";  // auto, scalar, or a SIMD target of this machine
  // -1: the method's own.
  int num_iterations = -1;       // of a photometric or prior pass
  int num_geom_iterations = -1;  // of a geometric pass
  int num_geom_passes = -1;
  int num_fine_iterations = -1;  // the same at levels finer than the coarsest
  int num_fine_geom_passes = -1;
  int max_views = -1;           // source views that judge a pixel in a visit
  double weak_gradient = 1.4f;  // grey levels per pixel
  double geom_weight = 0.1;     // lambda of the geometric term
  double geom_max_error = 5;    // pixels, cap of the geometric term
  int num_levels = -1;  // of the hierarchy; -1: by method and image size
  double filter_min_agreement = 0.5;  // see needed_views.h
  bool previews = false;   // colour pictures of the maps in stereo/previews
  bool overwrite = false;  // recompute maps that are complete
};

struct ControllerOptions {
  WorkspaceOptions workspace;
  std::string config_path;
  int random_seed = 0;
  PatchMatchStereoOptions patch_match;
  HpmOptions hpm;
};

}  // namespace hpm
