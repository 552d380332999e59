#include "src/engine/settled_pixels.h"

#include "src/prior/region_planes.h"
#include "tests/engine/half_textured.h"

#include <utility>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 80, kHeight = 40;
constexpr int kEdge = 30;  // column; to the left of it there is texture
constexpr float kDepth = 4;

// Planes that face the camera, a plain surface beside a textured one, and a
// source view one unit to the right.
class SettledPixelsTest : public testing::Test {
 protected:
  SettledPixelsTest()
      : views_(HalfTextured(kWidth, kHeight, kEdge)), map_(kWidth, kHeight) {
    views_.srcs[0].camera.t = {-1, 0, 0};
    regions_ = FindWeakRegions(
        *views_.ref.image, params_.weak_gradient, params_.region_min_share);
    map_.planes.assign(map_.planes.size(), AtDepth(kDepth));
  }

  static Plane AtDepth(float z) { return {{0, 0, -1}, z}; }
  // A plane so many pixels of parallax farther than kDepth.
  static Plane Farther(float pixels) {
    return AtDepth(1 / (1 / kDepth - pixels / kFocalLength));
  }
  static size_t At(int col, int row) {
    return static_cast<size_t>(row) * kWidth + col;
  }
  std::vector<uint8_t> ByCoarserLevel() const {
    return VisitsBelowCoarserLevel(views_, regions_, params_, map_);
  }
  void OnPriors() { SettleOnPriors(views_, regions_, params_, &map_); }

  static constexpr int kFew = 2, kAll = 255;  // visits
  static constexpr float kFocalLength = 40;   // pixels
  static constexpr int kCol = 55, kRow = 20;  // deep inside
  MethodParams params_;
  ViewSet views_;
  WeakRegions regions_;
  HypothesisMap map_;
};

TEST_F(SettledPixelsTest, BeforeAnythingIsFoundTextureDecides) {
  const std::vector<uint8_t> visits = VisitsByTexture(regions_);
  ASSERT_EQ(visits.size(), map_.planes.size());
  for (const int row : {0, kRow, kHeight - 1}) {
    for (int col = 0; col < kWidth; ++col) {
      EXPECT_EQ(visits[At(col, row)], regions_.At(col, row) > 0 ? kFew : kAll);
    }
    EXPECT_EQ(visits[At(kEdge / 2, row)], kAll);
    EXPECT_EQ(visits[At(kCol, row)], kFew);
  }
}

TEST_F(SettledPixelsTest, OnlyDeepInsideARegion) {
  const std::vector<uint8_t> visits = ByCoarserLevel();
  const int margin = params_.patch_radius + kRimWidth;
  for (const int row : {0, kRow, kHeight - 1}) {
    EXPECT_EQ(visits[At(kCol, row)], 0);
    EXPECT_EQ(visits[At(kWidth - 1, row)], 0);
    EXPECT_EQ(visits[At(kEdge / 2, row)], kAll);
    EXPECT_EQ(visits[At(kEdge + margin - 1, row)], kFew);
    EXPECT_EQ(visits[At(kEdge + margin + 4, row)], 0);  // texture is blurred
  }
}

// What no plane explains differs from place to place.
TEST_F(SettledPixelsTest, OnlyWherePlanesOfTheCoarserLevelGoOnInEachOther) {
  const int margin = params_.patch_radius + kRimWidth;
  for (const auto& [plane, goes_on] : {std::pair(Farther(0.8f), true),
                                       std::pair(Farther(1.2f), false),
                                       std::pair(Farther(-1.2f), false),
                                       std::pair(Plane{}, false)}) {
    for (const auto& [dcol, drow] : {std::pair(margin, 0),
                                     std::pair(-margin, 0),
                                     std::pair(0, margin),
                                     std::pair(0, -margin),
                                     std::pair(0, 0)}) {
      Plane* other = &map_.planes[At(kCol + dcol, kRow + drow)];
      const Plane before = *other;
      *other = plane;
      EXPECT_EQ(ByCoarserLevel()[At(kCol, kRow)], goes_on ? 0 : kFew)
          << plane.distance << " " << dcol << " " << drow;
      *other = before;
    }
  }
}

TEST_F(SettledPixelsTest, WhoLiesOnItsPriorTakesIt) {
  map_.priors.assign(map_.planes.size(), AtDepth(kDepth));
  const size_t near = At(kCol, kRow), far = At(kCol, kRow + 1);
  const size_t without = At(kCol, kRow + 2), missing = At(kCol, kRow + 3);
  const size_t textured = At(kEdge / 2, kRow);
  map_.planes[near] = map_.planes[textured] = Farther(0.8f);
  map_.planes[far] = Farther(1.2f);
  map_.priors[without].distance = 0;
  map_.planes[missing].distance = 0;
  const std::vector<Plane> before = map_.planes;
  const uint64_t generation = map_.generation;
  OnPriors();
  EXPECT_NE(map_.generation, generation);
  EXPECT_EQ(map_.visits[near], 0);
  EXPECT_EQ(map_.planes[near].distance, kDepth);
  for (const size_t at : {far, without, missing, textured}) {
    EXPECT_EQ(map_.visits[at], kAll) << at;
    EXPECT_EQ(map_.planes[at].distance, before[at].distance) << at;
  }
}

TEST_F(SettledPixelsTest, WithoutPriorsNobodySettles) {
  OnPriors();
  EXPECT_TRUE(map_.visits.empty());
}

}  // namespace
}  // namespace hpm
