// Every option of the program, grouped as on the command line, with its
// default: the one place where that stands. colmap_plugin/options/option_table
// maps names to these members.
#pragma once

#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/engine/method.h"
#include "src/engine/run_spec.h"

#include <string>

namespace hpm {

// "--PatchMatchStereo.*": COLMAP's names, types and defaults (3.8 and 4.x), but
// for those in WorkspaceOptions and ProblemOptions. Options whose meaning does
// not exist in this method are accepted and named once in the log when they are
// set; see docs/options.md.
struct PatchMatchStereoOptions {
  std::string gpu_index = "-1";
  int window_radius = 5;
  int window_step = 1;
  double sigma_spatial = -1;
  double sigma_color = 0.2f;
  int num_samples = 15;
  double ncc_sigma = 0.6f;
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
  std::string method = kDefaultMethod;
  std::string quality = "high";  // see colmap_plugin/options/quality.h
  std::string device = "auto";   // auto, cpu or cuda
  int gpu_images = -1;  // in flight per entry of gpu_index; -1: by threads,
                        // then memory
  std::string cpu_target =
      "auto";  // auto, scalar, or a SIMD target of this machine
  // -1: the method's own.
  int num_iterations = -1;       // of a photometric or prior pass
  int num_geom_iterations = -1;  // of a geometric pass
  int num_geom_passes = -1;
  int num_fine_iterations = -1;  // the same at levels finer than the coarsest
  int num_fine_geom_passes = -1;
  int max_views = -1;  // source views that judge a pixel in a visit
  double weak_gradient = MethodParams().weak_gradient;  // grey levels per pixel
  double geom_weight = MethodParams().geom_weight;      // lambda of that term
  double geom_max_error = MethodParams().geom_max_error;  // pixels, its cap
  int num_levels = -1;  // of the hierarchy; -1: by method and image size
  double filter_min_agreement = MapFilter().min_agreement;
  std::string log_format = "text";  // or json: one object a line
  bool keep_photometric = true;     // 0: only *.geometric.bin are published
  bool report = true;               // stereo/report.html at the end of a run
  bool confidence = false;  // stereo/confidence_maps beside the final maps
  bool previews = false;    // colour pictures of the maps in stereo/previews
  bool overwrite = false;   // recompute maps that are complete
  // Which part of the work this process does, see run_share.h.
  std::string shard = "0/1";
  std::string stage = "all";
};

struct ControllerOptions {
  WorkspaceOptions workspace;
  ProblemOptions problems;
  int random_seed = 0;
  PatchMatchStereoOptions patch_match;
  HpmOptions hpm;
};

// COLMAP's options about its own logging; accepted, never read.
struct LogOptions {
  bool log_to_stderr = false;                  // up to 3.13
  std::string log_target = "stderr_and_file";  // 4.0 and later, as all below
  std::string log_path;
  int log_level = 0;
  int log_severity = 0;
  bool log_color = true;
};

// What the command line holds.
struct ToolOptions {
  std::string project_path;
  ControllerOptions controller;
  LogOptions log;
};

}  // namespace hpm
