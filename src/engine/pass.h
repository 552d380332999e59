// One pass over a reference image, as data; a method is a list of passes
// (see schedule.h).
#pragma once

#include "src/core/initialize_pixel.h"

namespace hpm {

// Numbers of the algorithm that users may set; the defaults are those of the
// paper (section 4.1) or, where it gives none, of its authors' code.
struct MethodParams {
  int patch_radius = 5;     // pixels
  float sigma_spatial = 5;  // pixels
  float sigma_color = 3;    // grey levels
  float cut_color = 0;      // grey levels; see PatchShape; 0: not cut
  int num_view_draws = 15;
  int max_views = kMaxViews;
  float depth_perturbation = 0.02f;        // relative
  float normal_perturbation = 0.0314159f;  // radians per axis
  float same_plane_bound =
      0;  // pixels; planes closer than this share their costs
  float worst_cost = kMaxCost;  // of a view, see WeightedMean()
  float geom_weight = 0.1f;     // cost per pixel of reprojection error
  float geom_max_error = 5;     // pixels
  float prior_gamma = 0.5f;
  float prior_beta = 0.18f;
  float prior_depth_share =
      1.0f / 64;                   // sigma of the prior's depth / depth range
  float prior_angle = 0.0872665f;  // radians
  // Planes of regions without texture (src/prior/region_planes.h).
  float weak_gradient = 1.4f;        // grey levels per pixel
  float region_min_share = 0.0005f;  // of the image
  float region_max_error = 1;        // pixels; between views
  float region_max_residual = 0.5f;  // pixels; of a point to its plane
  int region_min_consistent = 3;     // views
  // In place of prior_gamma: matching says little in these regions.
  float region_gamma = 0.05f;
};

enum class PassKind { kBasic, kPrior, kGeometric };

// Priors for regions without texture: kWeak as any prior, kStrong where
// nothing but the prior is left to decide. A strong prior makes all views
// agree on it, right or wrong, so it comes last.
enum class RegionPriors { kNone, kWeak, kStrong };

struct Pass {
  PassKind kind;
  StartFrom start;
  int num_iterations;
  int id;  // position in the method: part of the key of the random numbers
  int level = 0;  // kPrior: the prior is built on maps halved this many times
  bool median = true;                          // clean up at the end
  RegionPriors regions = RegionPriors::kNone;  // kGeometric only
  // Where no region has a plane, triangles do (src/engine/offer_triangles.h).
  bool triangles = false;            // kGeometric with weak regions only
  bool ask_all_views = false;        // see ChooseViews()
  bool search_near = false;          // no hypotheses from the whole depth range
  int max_candidates = kNumRegions;  // regions that a visit looks into
  int max_views = kMaxViews;         // and not more than of MethodParams
  // A visit asks only max_views of the views that the pixel trusted last,
  // those that its neighbours vote for; see ChooseViews().
  bool few_views = false;
  // Only one colour of the checkerboard is visited after the start; after each
  // iteration the other one follows it (src/core/take_neighbour.h).
  bool half_visits = false;
  // kBasic: pixels without texture are visited twice at most.
  bool rest_plain = false;
  // kGeometric: starts with src/engine/view_propagation.h.
  bool propagate_views = false;
  // After the clean-up every pixel takes the plane that its neighbourhood lies
  // on (src/engine/local_planes.h).
  bool fit_planes = false;

  int first_color() const { return half_visits ? 1 : 0; }
  // Half-sweeps that count for the progress: those with matching costs.
  int NumSteps() const {
    return NumStartSteps() + (2 - first_color()) * num_iterations;
  }
  int NumStartSteps() const { return start == StartFrom::kStored ? 0 : 2; }
};

}  // namespace hpm
