#include "src/core/initialize_pixel.h"

#include "tests/core/fake_cost.h"
#include "tests/core/test_cameras.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

float BestOf(const std::vector<float>& costs, uint32_t* mask) {
  const std::vector<uint8_t> views = {0, 1, 2, 3, 4, 5};
  return BestViewsCost(
      costs.data(), views.data(), static_cast<int>(costs.size()), mask);
}

TEST(BestViewsCost, NamesTheViewsThatWereAsked) {
  const float costs[] = {0.2f, 2.0f, 0.4f};
  const uint8_t views[] = {1, 4, 6};
  uint32_t mask;
  EXPECT_FLOAT_EQ(BestViewsCost(costs, views, 3, &mask), 0.3f);
  EXPECT_EQ(mask, 0b1000010u);
}

TEST(BestViewsCost, IsTheMeanOfTheFourSmallest) {
  uint32_t mask;
  EXPECT_FLOAT_EQ(BestOf({0.9f, 0.1f, 0.8f, 0.3f, 0.2f, 0.7f}, &mask),
                  (0.1f + 0.2f + 0.3f + 0.7f) / 4);
  EXPECT_EQ(mask, 0b111010u);
}

TEST(BestViewsCost, SkipsViewsThatSeeNothing) {
  uint32_t mask;
  EXPECT_FLOAT_EQ(BestOf({2.0f, 0.4f, 2.0f, 0.2f}, &mask), 0.3f);
  EXPECT_EQ(mask, 0b1010u);
}

TEST(BestViewsCost, IsTheWorstIfNoViewSeesAnything) {
  uint32_t mask = 77;
  EXPECT_EQ(BestOf({2.0f, 2.0f}, &mask), kMaxCost);
  EXPECT_EQ(mask, 0u);
}

class InitializePixelTest : public testing::Test {
 protected:
  InitializePixelTest() {
    params_.ref = MakeTestCamera(9, 9, 10, 0, {0, 0, 0});
    params_.num_views = 2;
    params_.depth_min = 2;
    params_.depth_max = 6;
  }

  // Plane of pixel (4, 3) after starting there.
  Plane Start(StartFrom start, int draw = 0) {
    std::vector<Plane> planes(81, Plane{{0, 0, 0}, 0});
    std::vector<float> costs(81, kMaxCost);
    std::vector<uint32_t> masks(81, 0);
    std::vector<Plane> priors(81, Plane{{0, 0, 0}, 0});
    planes[31] = stored_;
    costs[31] = stored_cost_;
    priors[31] = prior_;
    const FakeCost cost = {[](const Plane&, int) { return 0.3f; }};
    Rng rng(1, draw, 0);
    InitializePixel(
        params_,
        {9, 9, planes.data(), costs.data(), masks.data(), priors.data()},
        start,
        cost,
        &rng,
        4,
        3);
    EXPECT_FLOAT_EQ(costs[31], 0.3f);
    EXPECT_EQ(masks[31], 3u);
    return planes[31];
  }

  float Depth(const Plane& plane) const {
    return DepthAt(params_.ref, plane, 4, 3);
  }

  VisitParams params_ = {};
  Plane stored_ = {{0, 0, -1}, 3};
  float stored_cost_ = 0.5f;
  Plane prior_ = {{0, 0, -1}, 5};
};

TEST_F(InitializePixelTest, RandomStartLiesInTheDepthRangeAndFacesTheCamera) {
  float lowest = 100, highest = 0;
  for (int i = 0; i < 1000; ++i) {
    const Plane plane = Start(StartFrom::kRandom, i);
    ASSERT_GE(Depth(plane), 2 * (1 - 1e-4));
    ASSERT_LE(Depth(plane), 6 * (1 + 1e-4));
    ASSERT_LE(Dot(plane.normal, RayAt(params_.ref, 4, 3)), 0);
    lowest = std::fmin(lowest, Depth(plane));
    highest = std::fmax(highest, Depth(plane));
  }
  EXPECT_LT(lowest, 2.1);
  EXPECT_GT(highest, 5.9);
}

TEST_F(InitializePixelTest, CurrentStartKeepsTheStoredPlane) {
  const Plane plane = Start(StartFrom::kCurrent);
  EXPECT_EQ(plane.distance, stored_.distance);
  EXPECT_EQ(plane.normal.z, stored_.normal.z);
}

TEST(StartsAt, AMissingStartTouchesOnlyWhatIsMissing) {
  const Plane none = {{0, 0, 0}, 0}, some = {{0, 0, -1}, 3};
  EXPECT_TRUE(StartsAt(StartFrom::kMissing, none));
  EXPECT_FALSE(StartsAt(StartFrom::kMissing, some));
  EXPECT_TRUE(StartsAt(StartFrom::kRandom, none));
  EXPECT_TRUE(StartsAt(StartFrom::kCurrent, none));
}

class ViewsToAskTest : public testing::Test {
 protected:
  uint32_t Asked(StartFrom start, int col, int row) {
    VisitParams params = {};
    params.num_views = 6;
    params.ask_all_views = ask_all_;
    const PixelState state = {3, 3, nullptr, nullptr, trusted_.data(), nullptr};
    return ViewsToAsk(params, state, start, col, row);
  }
  std::vector<uint32_t> trusted_ = std::vector<uint32_t>(9, 0);
  bool ask_all_ = false;
};

TEST_F(ViewsToAskTest, ThePaperAsksAll) {
  trusted_[0] = 0b000011;
  ask_all_ = true;
  EXPECT_EQ(Asked(StartFrom::kCurrent, 1, 0), 0b111111u);
}

TEST_F(ViewsToAskTest, TheSecondColourAsksWhatItsNeighboursTrusted) {
  trusted_[0] = 0b000011;  // left
  trusted_[2] = 0b000110;  // right
  trusted_[4] = 0b100000;  // below
  trusted_[1] = 0b001000;  // its own: of another hypothesis
  trusted_[8] = 0b010000;  // not a neighbour
  EXPECT_EQ(Asked(StartFrom::kCurrent, 1, 0), 0b100111u);
}

TEST_F(ViewsToAskTest, AllViewsWhereNothingIsKnown) {
  EXPECT_EQ(Asked(StartFrom::kCurrent, 1, 0), 0b111111u);
  trusted_ = std::vector<uint32_t>(9, 1);
  EXPECT_EQ(Asked(StartFrom::kCurrent, 1, 0), 1u);
  EXPECT_EQ(Asked(StartFrom::kCurrent, 1, 1), 0b111111u);  // the first colour
  EXPECT_EQ(Asked(StartFrom::kRandom, 1, 0), 0b111111u);
  EXPECT_EQ(Asked(StartFrom::kPrior, 1, 0), 0b111111u);
}

TEST_F(InitializePixelTest, CurrentStartWithoutAPlaneIsRandom) {
  stored_ = {{0, 0, 0}, 0};
  EXPECT_GT(Start(StartFrom::kCurrent).distance, 0);
}

TEST_F(InitializePixelTest, PriorStartTakesThePriorSlightlyPerturbed) {
  for (int i = 0; i < 300; ++i) {
    const Plane plane = Start(StartFrom::kPrior, i);
    EXPECT_NEAR(Depth(plane), 5, 5 * 0.0601);
    EXPECT_LT(AngleBetween(plane.normal, prior_.normal),
              1.05 * std::sqrt(3.0) * kPriorNormalSpread);
  }
}

TEST_F(InitializePixelTest, PriorStartKeepsConvincingHypotheses) {
  stored_cost_ = 0.09f;
  EXPECT_EQ(Depth(Start(StartFrom::kPrior)), Depth(stored_));
}

TEST_F(InitializePixelTest, PriorStartWithoutAPriorKeepsTheStoredPlane) {
  prior_.distance = 0;
  EXPECT_EQ(Depth(Start(StartFrom::kPrior)), Depth(stored_));
}

}  // namespace
}  // namespace hpm
