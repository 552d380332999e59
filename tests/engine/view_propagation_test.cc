#include "src/engine/view_propagation.h"

#include "src/engine/pass.h"
#include "tests/engine/plane_in_views.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// The sources know where the plane is, the reference has something else.
class ViewPropagationTest : public PlaneInViews {
 protected:
  ViewPropagationTest() { SetMap(1.5f); }

  // Planes that face the camera.
  void SetMap(float scale) {
    PlaneInViews::SetMap(scale,
                         std::vector<Vec3f>(map_.planes.size(), {0, 0, -1}));
  }

  float DepthOf(size_t at) const {
    return DepthAt(views_.ref.camera,
                   map_.planes[at],
                   static_cast<float>(at % kWidth),
                   static_cast<float>(at / kWidth));
  }

  // The images match best on `matching_scale_` times the true depth, where it
  // costs `least_cost_`.
  void Propagate() {
    PropagateViews(
        views_,
        FindWeakRegions(
            *views_.ref.image, params_.weak_gradient, params_.region_min_share),
        [this](const std::vector<PixelPlane>& planes) {
          std::vector<float> costs;
          for (const auto& [col, row, plane] : planes) {
            const float z = DepthAt(views_.ref.camera,
                                    plane,
                                    static_cast<float>(col),
                                    static_cast<float>(row));
            const float best =
                matching_scale_ *
                TrueDepth(static_cast<size_t>(row) * kWidth + col);
            costs.push_back(least_cost_ +
                            relative_cost_ * std::fabs(z / best - 1) +
                            (plane.normal.z == -1 ? kept_cost_ : 0));
          }
          num_asked_ += planes.size();
          return costs;
        },
        cancel_,
        &map_);
  }

  // Share of pixels within half a percent of `scale` times the true depth.
  double ShareAt(float scale) const {
    int count = 0;
    for (size_t at = 0; at < map_.planes.size(); ++at)
      count += std::fabs(DepthOf(at) / (scale * TrueDepth(at)) - 1) < 0.005f;
    return count / static_cast<double>(map_.planes.size());
  }

  MethodParams params_;
  const CancelToken* cancel_ = nullptr;
  size_t num_asked_ = 0;
  float matching_scale_ = 1;
  float least_cost_ = 0;
  float kept_cost_ = 0;      // more, of planes that face the camera
  float relative_cost_ = 1;  // of being off, per relative depth
};

TEST_F(ViewPropagationTest, WhatTheSourcesFoundComesWithItsNormal) {
  EXPECT_EQ(ShareAt(1), 0);
  Propagate();
  EXPECT_GT(ShareAt(1), 0.8);
  int num_taken = 0;
  for (size_t at = 0; at < map_.planes.size(); ++at) {
    if (map_.planes[at].normal.z == -1) continue;
    ++num_taken;
    EXPECT_GT(Dot(map_.planes[at].normal, TrueNormals()[at]), std::cos(0.02f));
  }
  EXPECT_GT(num_taken, 0.8 * kWidth * kHeight);
}

TEST_F(ViewPropagationTest, OneSourceIsEnough) {
  for (size_t j = 1; j < views_.srcs.size(); ++j)
    views_.srcs[j].inverse_depth = nullptr;
  Propagate();
  EXPECT_GT(ShareAt(1), 0.5);
}

TEST_F(ViewPropagationTest, TheMostSourcesHaveTheWord) {
  SetDepth(0, 1.2f);
  Propagate();
  EXPECT_GT(ShareAt(1), 0.6);
}

TEST_F(ViewPropagationTest, TheImagesDecide) {
  matching_scale_ = 1.5f;
  Propagate();
  EXPECT_GT(num_asked_, 0u);
  EXPECT_EQ(ShareAt(1.5f), 1);
}

TEST_F(ViewPropagationTest, WhatMatchesNowhereIsNotTaken) {
  least_cost_ = 0.55f;
  Propagate();
  EXPECT_GT(ShareAt(1), 0.8);
  SetMap(1.5f);
  least_cost_ = 0.65f;
  Propagate();
  EXPECT_EQ(ShareAt(1.5f), 1);
}

TEST_F(ViewPropagationTest, ALittleBetterIsNotEnough) {
  relative_cost_ = 0.09f;  // half of it for the map
  Propagate();
  EXPECT_GT(num_asked_, 0u);
  EXPECT_EQ(ShareAt(1.5f), 1);
  relative_cost_ = 0.11f;
  Propagate();
  EXPECT_GT(ShareAt(1), 0.8);
}

TEST_F(ViewPropagationTest, WhatAllSourcesFoundStays) {
  SetMap(1);
  Propagate();
  EXPECT_EQ(num_asked_, 0u);
  EXPECT_EQ(ShareAt(1), 1);
}

TEST_F(ViewPropagationTest, WhatAsManySourcesFoundStays) {
  views_.srcs[2].inverse_depth = nullptr;
  SetDepth(1, 1.2f);
  SetMap(1);  // as source 0 says
  matching_scale_ = 1.2f;
  Propagate();
  EXPECT_LT(num_asked_, 0.3 * kWidth * kHeight);  // what one of them sees alone
  EXPECT_GT(ShareAt(1), 0.7);
}

TEST_F(ViewPropagationTest, LoneVoicesThatComeFirstDoNotSilenceTheOthers) {
  const View agreeing = views_.srcs[2];
  for (int copies = 0; copies < 2; ++copies) views_.srcs.push_back(agreeing);
  SetDepth(0, 1.2f);
  SetDepth(1, 1.8f);
  Propagate();
  EXPECT_GT(ShareAt(1), 0.6);

  SetMap(1);
  num_asked_ = 0;
  Propagate();
  EXPECT_LT(num_asked_, 0.3 * kWidth * kHeight);  // what the three do not see
}

TEST_F(ViewPropagationTest, NoSlopeIsTakenAcrossADepthEdge) {
  for (size_t j = 0; j < views_.srcs.size(); ++j) {
    std::vector<float> inverse;
    for (const float z : rendered_[j + 1].truth.depth)
      inverse.push_back((inverse.size() % kWidth < kWidth / 2 ? 1 : 0.9f) / z);
    views_.srcs[j].inverse_depth =
        std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
  }
  relative_cost_ = 0.09f;  // they all match
  kept_cost_ = 0.5f;
  Propagate();
  for (size_t at = 0; at < map_.planes.size(); ++at) {
    if (map_.planes[at].normal.z == -1) continue;
    EXPECT_GT(Dot(map_.planes[at].normal, TrueNormals()[at]), std::cos(0.1f));
  }
}

TEST_F(ViewPropagationTest, StopsWhenCancelled) {
  CancelToken cancel;
  cancel.Cancel();
  cancel_ = &cancel;
  EXPECT_THROW(Propagate(), Error);
  EXPECT_EQ(ShareAt(1.5f), 1);
}

TEST_F(ViewPropagationTest, NothingComesFromOutsideTheDepthRange) {
  views_.depth_min = 1e6f;
  views_.depth_max = 2e6f;
  Propagate();
  EXPECT_EQ(num_asked_, 0u);
}

TEST_F(ViewPropagationTest, NothingComesWhereThereIsNoTexture) {
  views_.ref.image = std::make_shared<const GrayImage>(
      GrayImage{kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight, 128)});
  Propagate();
  EXPECT_EQ(num_asked_, 0u);
}

TEST_F(ViewPropagationTest, WithoutDepthMapsNothingComes) {
  for (View& src : views_.srcs) src.inverse_depth = nullptr;
  Propagate();
  EXPECT_EQ(num_asked_, 0u);
  EXPECT_EQ(ShareAt(1.5f), 1);
}

}  // namespace
}  // namespace hpm
