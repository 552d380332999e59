#include "src/engine/method.h"

#include "src/base/error.h"

namespace hpm {
namespace {

constexpr int kNever = 1 << 30;

// A row of the paper: three iterations everywhere, two geometric passes, levels
// down to 1000 pixels, as in the authors' code; the paper gives no counts.
Method Paper(const char* name,
             const char* summary,
             bool non_local,
             bool extensible,
             Priors priors,
             bool pyramid) {
  return {name,
          summary,
          non_local,
          extensible,
          priors,
          pyramid,
          1000,
          kNever,
          {3, 3, 2, 0, 0, kMaxViews},
          {}};
}

// Numbers and departures are those that no scene of the suite speaks against
// (docs/ablation.md, docs/benchmarks.md).
Method Plus() {
  Departures departures;
  departures.cut_color = 15;
  departures.same_plane_bound = 0.2f;
  departures.worst_cost = 1;
  departures.ask_all_views = false;
  departures.search_near = true;
  departures.geom_candidates = 4;
  departures.geom_views = 2;
  departures.half_visits = true;
  departures.rest_plain = true;
  departures.propagate_views = true;
  departures.triangles = true;
  departures.fit_planes = true;
  return {kDefaultMethod,
          "the default: HPM-MVS with planes of regions that have evidence of "
          "their own",
          true,
          true,
          Priors::kRegions,
          false,
          350,
          200,
          {3, 1, 2, 5, 1, 4},
          departures};
}

}  // namespace

const std::vector<Method>& Methods() {
  using P = Priors;
  // clang-format off
  static const std::vector<Method> methods = {
      Plus(),
      Paper("hpm", "HPM-MVS as published", true, true, P::kAll, false),
      Paper("hpm_fast", "HPM-MVS fast as published: the coarsest prior only", true, true, P::kCoarsest, false),
      Paper("nesp_pa", "NESP with the prior of full size", true, true, P::kFull, false),
      Paper("nesp", "NESP without priors", true, true, P::kNone, false),
      Paper("nsp", "NESP without its extension", true, false, P::kNone, false),
      Paper("esp", "NESP's extension on ACMH's pattern", false, true, P::kNone, false),
      Paper("acmh", "ACMH with geometric consistency", false, false, P::kNone, false),
      Paper("hpm_no_nesp", "HPM-MVS with ACMH's pattern", false, false, P::kAll, false),
      Paper("hpm_fast_no_nesp", "HPM-MVS fast with ACMH's pattern", false, false, P::kCoarsest, false),
      Paper("acmm", "ACMM: a pyramid of images", false, false, P::kNone, true),
      Paper("acmp", "ACMP: a prior of full size", false, false, P::kFull, false),
      Paper("acmmp", "ACMMP: both", false, false, P::kFull, true),
      Paper("acmm_nesp", "ACMM with NESP", true, true, P::kNone, true),
      Paper("acmp_nesp", "ACMP with NESP", true, true, P::kFull, false),
      Paper("acmmp_nesp", "ACMMP with NESP", true, true, P::kFull, true),
  };
  // clang-format on
  return methods;
}

std::vector<std::string> MethodNames() {
  std::vector<std::string> names;
  for (const Method& method : Methods()) names.emplace_back(method.name);
  return names;
}

const Method& FindMethod(const std::string& name) {
  std::string names;
  for (const Method& method : Methods()) {
    if (name == method.name) return method;
    names += (names.empty() ? "" : ", ") + std::string(method.name);
  }
  throw Error(ErrorCode::kUsage,
              "method " + name + ": unknown; use one of " + names);
}

MethodParams DefaultParams(const Method& method) {
  MethodParams params;
  params.cut_color = method.departures.cut_color;
  params.same_plane_bound = method.departures.same_plane_bound;
  params.worst_cost = method.departures.worst_cost;
  params.max_views = method.numbers.max_views;
  return params;
}

int AutomaticLevels(const Method& method, int side) {
  int num_levels = side > method.min_halved_side ? 2 : 1;
  while (side >> (num_levels - 1) > method.max_coarsest_side) ++num_levels;
  return num_levels;
}

}  // namespace hpm
