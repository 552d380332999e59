#include "src/engine/offer_triangles.h"

#include "tests/prior/prior_scene.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 80, kHeight = 60;
// Texture is in two strips, plain wall between them and beyond.
constexpr int kTop = 20, kBottom = 40, kStrip = 5;  // rows

bool HasTexture(int row) {
  return (row >= kTop && row < kTop + kStrip) ||
         (row >= kBottom && row < kBottom + kStrip);
}

size_t At(int col, int row) { return static_cast<size_t>(row) * kWidth + col; }

// A tilted wall that is found where it has texture; elsewhere chance has put
// something at half its distance.
class OfferTrianglesTest : public testing::Test {
 protected:
  OfferTrianglesTest() : map_(kWidth, kHeight) {
    views_.ref.camera = PriorCamera(kWidth, kHeight);
    views_.depth_min = 0.5f;
    views_.depth_max = 50;
    regions_.width = kWidth;
    regions_.height = kHeight;
    regions_.num_regions = 1;
    regions_.label.assign(map_.planes.size(), 1);
    map_.planes.assign(map_.planes.size(), Near());
    map_.priors.assign(map_.planes.size(), Plane{{0, 0, 0}, 0});
    for (int row = 0; row < kHeight; ++row) {
      if (!HasTexture(row)) continue;
      for (int col = 0; col < kWidth; ++col) {
        regions_.label[At(col, row)] = 0;
        map_.planes[At(col, row)] = TiltedPlane();
      }
    }
  }

  static Plane Near() {
    return {TiltedPlane().normal, TiltedPlane().distance / 2};
  }

  // What has texture matches, or nothing does.
  void Offer(float best_cost = 0) {
    const auto score = [&](const std::vector<PixelPlane>& planes) {
      num_asked_ += static_cast<int>(planes.size());
      std::vector<float> costs;
      for (const PixelPlane& asked : planes)
        costs.push_back(HasTexture(asked.row) ? best_cost : 1.0f);
      return costs;
    };
    OfferTriangles(views_, regions_, {0, agreement_}, score, &map_);
  }

  void ExpectWall(int col, int row) const {
    for (const auto* planes : {&map_.priors, &map_.planes}) {
      const Plane& plane = (*planes)[At(col, row)];
      ASSERT_GT(plane.distance, 0) << col << " " << row;
      EXPECT_NEAR(
          DepthDifference(views_.ref.camera, plane, TiltedPlane(), col, row),
          0,
          1e-4f);
    }
  }

  void ExpectNothingOffered(int col, int row) const {
    EXPECT_EQ(map_.priors[At(col, row)].distance, 0) << col << " " << row;
    EXPECT_EQ(map_.planes[At(col, row)].distance, Near().distance);
  }

  void ExpectNothingOfferedAnywhere() const {
    for (int row = 0; row < kHeight; ++row) {
      if (HasTexture(row)) continue;
      for (int col = 0; col < kWidth; ++col) ExpectNothingOffered(col, row);
    }
  }

  ViewSet views_;
  WeakRegions regions_;
  HypothesisMap map_;
  float agreement_ = 0.4f;  // on the plain wall
  int num_asked_ = 0;
};

TEST_F(OfferTrianglesTest, PlainPixelsBetweenWhatMatchesGetItsPlane) {
  Offer();
  for (int row = kTop + kStrip; row < kBottom; ++row)
    for (int col = 10; col < kWidth - 10; ++col) ExpectWall(col, row);
}

TEST_F(OfferTrianglesTest, NothingIsOfferedOutsideTheTriangles) {
  Offer();
  for (int col = 0; col < kWidth; ++col) {
    for (const int row : {0, kTop - 1, kBottom + kStrip, kHeight - 1})
      ExpectNothingOffered(col, row);
  }
}

TEST_F(OfferTrianglesTest, NothingIsOfferedToTexture) {
  Offer();
  EXPECT_EQ(map_.priors[At(kWidth / 2, kTop)].distance, 0);
  EXPECT_EQ(map_.priors[At(kWidth / 2, kBottom)].distance, 0);
}

TEST_F(OfferTrianglesTest, WhatRegionsHaveFoundStays) {
  const Plane mined = {{0, 0, -1}, 7};
  map_.priors[At(kWidth / 2, 30)] = mined;
  Offer();
  EXPECT_EQ(map_.priors[At(kWidth / 2, 30)].distance, mined.distance);
  EXPECT_EQ(map_.planes[At(kWidth / 2, 30)].distance, Near().distance);
  ExpectWall(kWidth / 2 + 1, 30);
}

TEST_F(OfferTrianglesTest, NothingIsOfferedWhereNothingMatches) {
  Offer(/*best_cost=*/0.2f);
  ExpectNothingOfferedAnywhere();
}

TEST_F(OfferTrianglesTest, NothingIsOfferedWhereViewsAgreeOnHalf) {
  agreement_ = 0.6f;
  Offer();
  ExpectNothingOfferedAnywhere();
}

TEST_F(OfferTrianglesTest, NothingIsAskedWhereAllIsExplained) {
  map_.priors.assign(map_.priors.size(), Near());
  Offer();
  EXPECT_EQ(num_asked_, 0);
}

}  // namespace
}  // namespace hpm
