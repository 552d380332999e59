// A pixel that more views confirm is trusted more.
#include "src/engine/confidence.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kNumSources = 4;
constexpr int kWidth = 128;
constexpr size_t kPixel = 120;  // that all sources see

// A camera at the origin and four beside it; every plane faces them at depth 4.
class ConfidenceTest : public testing::Test {
 protected:
  ConfidenceTest() : map_(kWidth, 2) {
    views_.ref = ViewAt(0);
    for (int j = 1; j <= kNumSources; ++j)
      views_.srcs.push_back(ViewAt(0.5f * static_cast<float>(j)));
    map_.planes.assign(map_.planes.size(), {{0, 0, -1}, 4});
    map_.costs.assign(map_.costs.size(), 0.2f);
  }

  View ViewAt(float x) const {
    const auto picture = std::make_shared<GrayImage>();
    *picture = {map_.width, map_.height, std::vector<uint8_t>(2 * kWidth, 7)};
    const Camera camera = {map_.width,
                           map_.height,
                           80,
                           80,
                           63.5f,
                           0.5f,
                           {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
                           {-x, 0, 0}};
    return {camera, picture, nullptr};
  }

  // Of that pixel, where these sources confirm all pixels.
  float Of(uint32_t consistent) const {
    const NeededViews needed(
        views_, map_, {-1, 0, 1, 2}, 0.5, /*geometric=*/false);
    const std::vector<uint32_t> all(map_.planes.size(), consistent);
    return Confidence(views_, needed, map_, all)[kPixel];
  }

  ViewSet views_;
  HypothesisMap map_;
};

TEST_F(ConfidenceTest, RisesWithEveryViewThatAgrees) {
  float before = -1;
  for (const uint32_t consistent : {0b0u, 0b1u, 0b11u, 0b111u, 0b1111u}) {
    const float confidence = Of(consistent);
    EXPECT_GE(confidence, 0);
    EXPECT_LE(confidence, 1);
    EXPECT_GT(confidence, before) << consistent;
    before = confidence;
  }
}

TEST_F(ConfidenceTest, ViewsThatSeeThePixelAndDoNotAgreeSpeakAgainstIt) {
  const float among_four = Of(0b11);
  views_.srcs.resize(2);
  EXPECT_GT(Of(0b11), among_four);
}

TEST_F(ConfidenceTest, BadMatchesAndUnexplainedRegionsAreTrustedLess) {
  const float good = Of(0b111);
  map_.costs.assign(map_.costs.size(), 0.9f);
  EXPECT_LT(Of(0b111), good);
  map_.costs.assign(map_.costs.size(), 0.2f);
  map_.unexplained.assign(map_.planes.size(), true);
  EXPECT_LT(Of(0b111), good);
}

TEST_F(ConfidenceTest, ViewsFurtherApartTellDepthBetter) {
  const float near = Of(0b111);
  for (View& src : views_.srcs) src.camera.t.x *= 2;
  EXPECT_GT(Of(0b111), near);
}

TEST_F(ConfidenceTest, NothingIsInfiniteOrNotANumber) {
  for (const float cost : {0.0f, 2.0f, 1e30f}) {
    map_.costs.assign(map_.costs.size(), cost);
    EXPECT_TRUE(std::isfinite(Of(0b1)));
  }
}

}  // namespace
}  // namespace hpm
