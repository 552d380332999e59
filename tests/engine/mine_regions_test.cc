#include "src/engine/mine_regions.h"

#include "tests/engine/plane_in_views.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

// Without any texture: one region.
class MineRegionsTest : public PlaneInViews {
 protected:
  MineRegionsTest() {
    views_.ref.image = std::make_shared<const GrayImage>(GrayImage{
        kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight, 128)});
    SetMap(1);
  }

  void SetMap(float scale) { PlaneInViews::SetMap(scale, TrueNormals()); }

  // As if the images matched `costs_` worse for each unit of 1/z beside the
  // depth that is `matching_scale_` times the true one.
  std::vector<float> Score(const std::vector<PixelPlane>& planes) {
    std::vector<float> costs;
    for (const auto& [col, row, plane] : planes) {
      scored_.push_back(plane);
      if (row < first_sighted_row_) {
        costs.push_back(0.5f);
        continue;
      }
      const float z = DepthAt(views_.ref.camera,
                              plane,
                              static_cast<float>(col),
                              static_cast<float>(row));
      const float true_depth =
          TrueDepth(static_cast<size_t>(row) * kWidth + col);
      costs.push_back(
          0.5f + slope_ * std::abs(1 / z - 1 / (matching_scale_ * true_depth)));
    }
    return costs;
  }
  std::vector<Plane> Mine() { return MineAll().priors; }
  MinedRegions MineAll() {
    return MineRegions(
        views_,
        FindWeakRegions(
            *views_.ref.image, params_.weak_gradient, params_.region_min_share),
        params_,
        map_,
        7,
        [this](const auto& p) { return Score(p); });
  }

  // Mean depth of the priors over the truth.
  double MeanScale(const std::vector<Plane>& priors) const {
    double sum = 0;
    for (int row = 0; row < kHeight; ++row) {
      for (int col = 0; col < kWidth; ++col) {
        const size_t at = static_cast<size_t>(row) * kWidth + col;
        EXPECT_GT(priors[at].distance, 0);
        sum += DepthAt(views_.ref.camera,
                       priors[at],
                       static_cast<float>(col),
                       static_cast<float>(row)) /
               TrueDepth(at);
      }
    }
    return sum / (kWidth * kHeight);
  }

  MethodParams params_;
  std::vector<Plane> scored_;
  float slope_ = 0;  // the images say nothing
  int first_sighted_row_ = 0;
  float matching_scale_ = 1;
};

TEST_F(MineRegionsTest, APlaneOnWhichAllAgreeIsFound) {
  const std::vector<Plane> priors = Mine();
  ASSERT_EQ(priors.size(), map_.planes.size());
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const size_t at = static_cast<size_t>(row) * kWidth + col;
      EXPECT_NEAR(DepthAt(views_.ref.camera,
                          priors[at],
                          static_cast<float>(col),
                          static_cast<float>(row)),
                  TrueDepth(at),
                  1e-3f * TrueDepth(at));
    }
  }
}

// The error of the reference alone shrinks to a quarter: three views correct
// it.
TEST_F(MineRegionsTest, AgreeingViewsAreAveraged) {
  constexpr float kSlip = 0.004f;
  SetMap(1 + kSlip);
  EXPECT_NEAR(MeanScale(Mine()), 1 + kSlip / 4, 0.1 * kSlip);
}

TEST_F(MineRegionsTest, ViewsThatDisagreeHaveNoSay) {
  SetDepth(0, 1.2f);
  params_.region_min_consistent = 2;
  EXPECT_NEAR(MeanScale(Mine()), 1, 1e-3);
  params_.region_min_consistent = 3;
  const std::vector<Plane> priors = Mine();
  ASSERT_EQ(priors.size(), map_.planes.size());
  for (const Plane& prior : priors) EXPECT_EQ(prior.distance, 0);
}

// Two of the three sources are zoomed in on a part of what the other one sees.
TEST_F(MineRegionsTest, ViewsOfAPartOfTheImageAreNotAskedForTheRest) {
  for (const size_t j : {1, 2}) {
    views_.srcs[j].camera.fx *= 4;
    views_.srcs[j].camera.fy *= 4;
  }
  EXPECT_NEAR(MeanScale(Mine()), 1, 1e-3);
}

TEST_F(MineRegionsTest, WhatNoBelievedPlaneExplainsIsMarked) {
  const size_t size = map_.planes.size();
  EXPECT_EQ(MineAll().unexplained, std::vector<bool>(size, false));
  slope_ = 10;
  matching_scale_ = 0.8f;
  EXPECT_EQ(MineAll().unexplained, std::vector<bool>(size, true));
}

// Not all of the region is seen by as many views as must agree.
TEST_F(MineRegionsTest, AgreementIsTheShareOfARegionThatViewsAgreeOn) {
  const std::vector<float> agreement = MineAll().agreement;
  ASSERT_EQ(agreement.size(), 2u);
  EXPECT_GT(agreement[1], 0.7f);
  EXPECT_LE(agreement[1], 1);
  for (int row = 0; row < kHeight; row += 2) {
    for (int col = 0; col < kWidth; ++col)
      map_.planes[row * kWidth + col].distance *= 1.3f;
  }
  EXPECT_NEAR(MineAll().agreement[1], agreement[1] / 2, 0.02f);
}

// A roof below a sky: windows at the rim match best at the depth of the roof,
// those of the sky itself match anywhere.
TEST_F(MineRegionsTest, WindowsThatReachOverTheRimAreNoEvidence) {
  constexpr int kSkyline = kHeight / 2;
  GrayImage image = *views_.ref.image;
  for (int row = kSkyline; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col)
      image.data[row * kWidth + col] = (col / 3 + row / 3) % 2 == 0 ? 30 : 220;
  }
  views_.ref.image = std::make_shared<const GrayImage>(image);
  slope_ = 200;
  first_sighted_row_ = kSkyline - params_.patch_radius;
  for (int at = 0; at < first_sighted_row_ * kWidth; ++at)
    map_.planes[at].distance *= 1.3f;  // nothing agrees in the sky
  const MinedRegions mined = MineAll();
  ASSERT_EQ(mined.priors.size(), map_.planes.size());
  for (const Plane& prior : mined.priors) EXPECT_EQ(prior.distance, 0);
  EXPECT_TRUE(mined.unexplained[0]);
  // What lies at the rim is near texture; see kRimWidth.
  EXPECT_FALSE(mined.unexplained[(kSkyline - 4) * kWidth]);
  EXPECT_FALSE(mined.unexplained[(kHeight - 10) * kWidth]);
}

// All depth maps agree on a plane, but the images match better beside it.
TEST_F(MineRegionsTest, APlaneThatTheImagesContradictIsNotBelieved) {
  slope_ = 10;
  EXPECT_GT(Mine()[0].distance, 0);
  matching_scale_ = 0.8f;
  for (const Plane& prior : Mine()) EXPECT_EQ(prior.distance, 0);
}

// Crops of one photograph beside views from elsewhere: the former see no depth
// and must not make the planes beside a candidate infinite.
TEST_F(MineRegionsTest, ViewsFromTheReferencesOwnPlaceDoNoHarm) {
  const View twin = {views_.ref.camera, views_.ref.image, nullptr};
  views_.srcs.insert(views_.srcs.end(), 5, twin);
  slope_ = 10;
  const std::vector<Plane> priors = Mine();
  EXPECT_GT(priors[0].distance, 0);
  for (const Plane& plane : scored_) {
    ASSERT_TRUE(std::isfinite(plane.distance + plane.normal.z));
  }
  views_.srcs.erase(views_.srcs.begin(), views_.srcs.end() - 5);
  for (View& view : views_.srcs)
    view.inverse_depth = std::make_shared<const InverseDepthMap>(
        InverseDepthMap::Of(std::vector<float>(kWidth * kHeight, 0.2f)));
  for (const Plane& prior : Mine()) EXPECT_EQ(prior.distance, 0);
}

RegionPlane Candidate(double inside, double rim_on, double rim_behind) {
  RegionPlane plane = {};
  plane.inside = inside;
  plane.rim_on = rim_on;
  plane.rim_behind = rim_behind;
  plane.spread = 0.2;
  return plane;
}

TEST(IsBelievable, WhereImagesMatchBetterNothingElseIsAsked) {
  EXPECT_TRUE(IsBelievable(Candidate(0.1, 0, 0.9), {100, 0.05}));
  EXPECT_FALSE(IsBelievable(Candidate(0.9, 0.9, 0), {100, -0.05}));
  EXPECT_FALSE(IsBelievable(Candidate(0.9, 0.9, 0), {0, 0}));
}

TEST(IsBelievable, ElseTheRimOrMostOfTheInsideMustLieOnIt) {
  EXPECT_TRUE(IsBelievable(Candidate(0, 0.6, 0), {100, 0}));    // a roof
  EXPECT_TRUE(IsBelievable(Candidate(0.7, 0.1, 0), {100, 0}));  // a wall
  EXPECT_FALSE(IsBelievable(Candidate(0.2, 0.1, 0), {100, 0}));
  EXPECT_FALSE(IsBelievable(Candidate(0.2, 0.5, 0.4), {100, 0}));
  RegionPlane line = Candidate(0.7, 0.6, 0);
  line.spread = 0.01;
  EXPECT_FALSE(IsBelievable(line, {100, 0}));
}

TEST_F(MineRegionsTest, WithoutDepthMapsThereIsNothingToMine) {
  for (View& src : views_.srcs) src.inverse_depth = nullptr;
  EXPECT_TRUE(Mine().empty());
}

}  // namespace
}  // namespace hpm
