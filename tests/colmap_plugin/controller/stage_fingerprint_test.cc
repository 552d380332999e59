#include "colmap_plugin/controller/stage_fingerprint.h"

#include <set>
#include <type_traits>

#include <gtest/gtest.h>

namespace hpm {
namespace {

template <class Value>
Value Another(Value value) {
  if constexpr (std::is_same_v<Value, bool>) {
    return !value;
  } else {
    return static_cast<Value>(static_cast<double>(value) + 1);
  }
}

// members: all those of `whole`, in any order.
template <class Whole, class... Members>
void ExpectEveryMemberCounts(const Whole& whole, Members&... members) {
  std::set<std::string> seen;
  const auto hash = [&] {
    Fingerprint fingerprint;
    AddToFingerprint(whole, &fingerprint);
    return seen.insert(fingerprint.Hex()).second;
  };
  EXPECT_TRUE(hash());
  int number = 0;
  const auto change = [&](auto* member) {
    const auto before = *member;
    *member = Another(before);
    EXPECT_TRUE(hash()) << "member " << number;
    *member = before;
    ++number;
  };
  (change(&members), ...);
  EXPECT_FALSE(hash());
}

TEST(StageFingerprint, EveryNumberOfAMethodCounts) {
  MethodParams params;
  auto& [patch_radius,
         sigma_spatial,
         sigma_color,
         cut_color,
         num_view_draws,
         max_views,
         depth_perturbation,
         normal_perturbation,
         same_plane_bound,
         worst_cost,
         geom_weight,
         geom_max_error,
         prior_gamma,
         prior_beta,
         prior_depth_share,
         prior_angle,
         weak_gradient,
         region_min_share,
         region_max_error,
         region_max_residual,
         region_min_consistent,
         region_gamma] = params;
  ExpectEveryMemberCounts(params,
                          patch_radius,
                          sigma_spatial,
                          sigma_color,
                          cut_color,
                          num_view_draws,
                          max_views,
                          depth_perturbation,
                          normal_perturbation,
                          same_plane_bound,
                          worst_cost,
                          geom_weight,
                          geom_max_error,
                          prior_gamma,
                          prior_beta,
                          prior_depth_share,
                          prior_angle,
                          weak_gradient,
                          region_min_share,
                          region_max_error,
                          region_max_residual,
                          region_min_consistent,
                          region_gamma);
}

TEST(StageFingerprint, EveryMemberOfAPassCounts) {
  Pass pass = {PassKind::kBasic, StartFrom::kRandom, 1, 0};
  auto& [kind,
         start,
         num_iterations,
         id,
         level,
         median,
         regions,
         triangles,
         ask_all_views,
         search_near,
         max_candidates,
         max_views,
         few_views,
         half_visits,
         rest_plain,
         propagate_views,
         fit_planes] = pass;
  ExpectEveryMemberCounts(pass,
                          kind,
                          start,
                          num_iterations,
                          id,
                          level,
                          median,
                          regions,
                          triangles,
                          ask_all_views,
                          search_near,
                          max_candidates,
                          max_views,
                          few_views,
                          half_visits,
                          rest_plain,
                          propagate_views,
                          fit_planes);
}

}  // namespace
}  // namespace hpm
