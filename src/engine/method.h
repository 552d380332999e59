// The methods by name. A row holds all that sets a method apart: what the
// paper's tables switch, its numbers, and where it departs from the paper. The
// paper's rows depart nowhere.
#pragma once

#include "src/engine/pass.h"

#include <string>
#include <vector>

namespace hpm {

// Where planes to prefer come from.
enum class Priors {
  kNone,
  // Triangles of credible points, as the paper mines them: at full size, at the
  // coarsest level, at all levels.
  kFull,
  kCoarsest,
  kAll,
  kRegions,  // untextured regions on which views agree (mine_regions.h)
};

// Of the schedule, where the user gives none.
struct MethodNumbers {
  int num_iterations;       // red/black, of basic and prior passes
  int num_geom_iterations;  // of geometric passes
  int num_geom_passes;
  // kRegions: in place of num_iterations and num_geom_passes at levels finer
  // than the coarsest.
  int num_fine_iterations;
  int num_fine_geom_passes;
  int max_views;  // that judge a pixel in a visit
};

struct Departures {
  float cut_color = 0;          // see ColorWeight(); 0: not cut
  float same_plane_bound = 0;   // pixels, see NearlySame(); 0: not shared
  float worst_cost = kMaxCost;  // see WeightedMean()
  bool ask_all_views = true;    // see ChooseViews()
  // Searches of levels finer than the coarsest and all but the last geometric
  // pass of a level visit one colour of the checkerboard.
  bool half_visits = false;
  bool rest_plain = false;  // of the search of the coarsest level
  // Geometric passes.
  bool triangles = false;             // of the first, see offer_triangles.h
  bool search_near = false;           // no hypotheses from the whole range
  int geom_candidates = kNumRegions;  // regions that a visit looks into
  int geom_views = kMaxViews;         // few of those trusted; kMaxViews: all
  bool propagate_views = false;       // see src/engine/view_propagation.h
  bool fit_planes = false;  // the last one ends in src/engine/local_planes.h
};

// Of those who ask for no other.
constexpr const char* kDefaultMethod = "hpm_plus";

struct Method {
  const char* name;
  const char* summary;  // one line for help and documentation
  bool non_local;       // N of the paper's ablation
  bool extensible;      // E
  Priors priors;
  bool pyramid;  // runs on images of all levels, coarse to fine (ACMM)
  // Automatic number of levels: images are halved until the longer side is at
  // most max_coarsest_side; those above min_halved_side at least once.
  int max_coarsest_side;
  int min_halved_side;
  MethodNumbers numbers;
  Departures departures;
};

const std::vector<Method>& Methods();

// For messages and help.
std::vector<std::string> MethodNames();

// Throws Error(kUsage) that lists the names.
const Method& FindMethod(const std::string& name);

// Of a method as it stands in its row.
MethodParams DefaultParams(const Method& method);

// Levels for images whose longer side is `side` pixels.
int AutomaticLevels(const Method& method, int side);

}  // namespace hpm
