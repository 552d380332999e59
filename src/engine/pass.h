// One pass over a reference image, as data; a method is a list of passes
// (see schedule.h).
#pragma once

#include "src/core/initialize_pixel.h"

namespace hpm {

// Numbers of the algorithm that users may set; the defaults are those of the
// paper and its code (specification appendix B).
struct MethodParams {
  int patch_radius = 5;     // pixels
  float sigma_spatial = 5;  // pixels
  float sigma_color = 3;    // grey levels
  int num_view_draws = 15;
  float depth_perturbation = 0.02f;        // relative
  float normal_perturbation = 0.0314159f;  // radians per axis
  float same_plane_bound =
      0.05f;  // pixels; planes closer than this share their costs
  float geom_weight = 0.1f;  // cost per pixel of reprojection error
  float geom_max_error = 5;  // pixels
  float prior_gamma = 0.5f;
  float prior_beta = 0.18f;
  float prior_depth_share =
      1.0f / 64;                   // sigma of the prior's depth / depth range
  float prior_angle = 0.0872665f;  // radians
};

enum class PassKind { kBasic, kPrior, kGeometric };

struct Pass {
  PassKind kind;
  StartFrom start;
  int num_iterations;
  int id;  // position in the method: part of the key of the random numbers
  int level = 0;  // kPrior: the prior is built on maps halved this many times
  bool median = true;  // clean up at the end
};

}  // namespace hpm
