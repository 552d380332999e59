#include "colmap_plugin/controller/filter_losses.h"

#include "src/engine/needed_views.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 30, kHeight = 22;
constexpr float kDepth = 4;
constexpr float kDegree = 0.01745329f;

// A wall at kDepth seen by a reference and sources beside it.
class FilterLossesTest : public testing::Test {
 protected:
  FilterLossesTest() : map_(kWidth, kHeight), consistent_(kWidth * kHeight) {
    views_.ref.camera = CameraAt(0);
    views_.ref.image = std::make_shared<const GrayImage>();
    SetPlanes({0, 0, -1});
  }

  static Camera CameraAt(float x) {
    return {kWidth,
            kHeight,
            60,
            60,
            14.5f,
            10.5f,
            {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
            {-x, 0, 0}};
  }

  void SetPlanes(const Vec3f& normal) {
    for (int row = 0; row < kHeight; ++row) {
      for (int col = 0; col < kWidth; ++col) {
        map_.planes[row * kWidth + col] =
            PlaneFromDepth(views_.ref.camera,
                           static_cast<float>(col),
                           static_cast<float>(row),
                           kDepth,
                           Normalized(normal));
      }
    }
  }

  // depth 0: without maps.
  void AddSource(float x, float depth) {
    View view = {CameraAt(x), std::make_shared<const GrayImage>(), nullptr};
    if (depth > 0) {
      view.inverse_depth = std::make_shared<const InverseDepthMap>(
          InverseDepthMap::Of(std::vector<float>(kWidth * kHeight, 1 / depth)));
    }
    views_.srcs.push_back(view);
  }

  FilterLosses Count() const {
    const NeededViews needed(views_, map_, filter_, min_agreement_, geometric_);
    std::vector<bool> keep;
    for (size_t i = 0; i < consistent_.size(); ++i)
      keep.push_back(__builtin_popcount(consistent_[i]) >= needed.At(i));
    return CountFilterLosses(
        views_, map_, consistent_, keep, filter_, geometric_);
  }

  ViewSet views_ = {};
  HypothesisMap map_;
  std::vector<uint32_t> consistent_;
  FilterParams filter_ = {0.1f, 3 * kDegree, 1, 2};
  double min_agreement_ = 0.66;  // so that two of four are too few
  bool geometric_ = true;
};

FilterLosses All(FilterCriterion criterion) { return {{criterion, 1.0}}; }

TEST_F(FilterLossesTest, ConfirmedPixelsAreNotLost) {
  AddSource(0.5f, kDepth);
  std::fill(consistent_.begin(), consistent_.end(), 0b11);
  EXPECT_THAT(Count(), IsEmpty());
}

TEST_F(FilterLossesTest, SmallAngles) {
  AddSource(0.1f, kDepth);  // 1.4 degrees
  AddSource(-0.1f, kDepth);
  EXPECT_EQ(Count(), All(FilterCriterion::kAngle));
}

TEST_F(FilterLossesTest, SourcesBehindTheSurface) {
  SetPlanes({-1, 0, -0.5f});
  AddSource(5, kDepth);
  EXPECT_EQ(Count(), All(FilterCriterion::kFacing));
}

TEST_F(FilterLossesTest, OtherDepthsAndNone) {
  AddSource(0.3f, 2);
  EXPECT_EQ(Count(), All(FilterCriterion::kGeometry));
  views_.srcs.clear();
  AddSource(0.3f, 0);
  EXPECT_EQ(Count(), All(FilterCriterion::kGeometry));
}

TEST_F(FilterLossesTest, OtherImages) {
  AddSource(0.1f, kDepth);
  AddSource(0.3f, kDepth);  // passes all but the correlation
  const FilterLosses losses = Count();
  ASSERT_EQ(losses.count(FilterCriterion::kCorrelation), 1u);
  EXPECT_GT(losses.at(FilterCriterion::kCorrelation), 0.7);
  geometric_ = false;
  EXPECT_EQ(Count(), All(FilterCriterion::kCorrelation));
}

// Of five sources one looks past the wall, so that three of four must agree.
TEST_F(FilterLossesTest, UnexplainedPixelsNeedMostOfThoseThatSeeThem) {
  for (const float x : {0.3f, -0.3f, 0.4f, -0.4f, 20.0f}) AddSource(x, kDepth);
  std::fill(consistent_.begin(), consistent_.end(), 0b0011);
  EXPECT_THAT(Count(), IsEmpty());
  map_.unexplained.assign(map_.planes.size(), true);
  // Fewer see the wall at the borders of the image.
  const FilterLosses losses = Count();
  ASSERT_EQ(losses.count(FilterCriterion::kUnexplained), 1u);
  EXPECT_GT(losses.at(FilterCriterion::kUnexplained), 0.7);
  std::fill(consistent_.begin(), consistent_.end(), 0b0111);
  EXPECT_THAT(Count(), IsEmpty());
  std::fill(consistent_.begin(), consistent_.end(), 0b0011);
  min_agreement_ = 0;
  EXPECT_THAT(Count(), IsEmpty());
}

// Walls behind furniture would go otherwise.
TEST_F(FilterLossesTest, SourcesWithSomethingInBetweenAreNotNeeded) {
  for (const float x : {0.3f, -0.3f}) AddSource(x, kDepth);
  for (const float x : {0.4f, -0.4f}) AddSource(x, 0.7f * kDepth);
  std::fill(consistent_.begin(), consistent_.end(), 0b0011);
  map_.unexplained.assign(map_.planes.size(), true);
  EXPECT_THAT(Count(), IsEmpty());
  // A little nearer is another opinion of the same surface.
  views_.srcs.resize(2);
  for (const float x : {0.4f, -0.4f}) AddSource(x, 0.9f * kDepth);
  EXPECT_EQ(Count().count(FilterCriterion::kUnexplained), 1u);
}

// Else a run in which the maps of many sources failed would lose them all.
TEST_F(FilterLossesTest, SourcesWithoutMapsAreNotNeeded) {
  for (const float x : {0.3f, -0.3f}) AddSource(x, kDepth);
  for (const float x : {0.4f, -0.4f}) AddSource(x, 0);
  std::fill(consistent_.begin(), consistent_.end(), 0b0011);
  map_.unexplained.assign(map_.planes.size(), true);
  EXPECT_THAT(Count(), IsEmpty());
}

TEST_F(FilterLossesTest, TooFewConfirmations) {
  AddSource(0.3f, kDepth);
  std::fill(consistent_.begin(), consistent_.end(), 0b10);
  EXPECT_EQ(Count(), All(FilterCriterion::kNumConsistent));
}

TEST_F(FilterLossesTest, ImagesOfOnePixelAreLookedAt) {
  map_ = HypothesisMap(1, 1);
  consistent_ = {1};
  AddSource(0.3f, kDepth);
  EXPECT_EQ(Count(), All(FilterCriterion::kNumConsistent));
}

TEST(FilterWarnings, NameTheOptionOnceWithCountAndExample) {
  ControllerOptions options;
  EXPECT_THAT(
      FilterWarnings({{"a.jpg", {{FilterCriterion::kAngle, 0.2}}}}, options),
      IsEmpty());
  const auto lines =
      FilterWarnings({{"a.jpg", {{FilterCriterion::kAngle, 0.2}}},
                      {"b.jpg", {{FilterCriterion::kAngle, 0.98}}},
                      {"c.jpg", {{FilterCriterion::kAngle, 0.7}}}},
                     options);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], HasSubstr("2 of 3 images"));
  EXPECT_THAT(lines[0], HasSubstr("b.jpg: 98 %"));
  EXPECT_THAT(lines[0],
              HasSubstr("--PatchMatchStereo.filter_min_triangulation_angle"));
}

TEST(FilterWarnings, EveryCriterionHasItsOption) {
  ControllerOptions options;
  const std::pair<FilterCriterion, const char*> words[] = {
      {FilterCriterion::kGeometry, "filter_geom_consistency_max_cost"},
      {FilterCriterion::kCorrelation, "filter_min_ncc"},
      {FilterCriterion::kNumConsistent, "filter_min_num_consistent"},
      {FilterCriterion::kRange, "depth_max"}};
  for (const auto& [criterion, word] : words) {
    EXPECT_THAT(FilterWarnings({{"a.jpg", {{criterion, 0.99}}}}, options),
                ElementsAre(HasSubstr(word)));
  }
  // Whoever cuts out one thing wants to lose the rest.
  EXPECT_THAT(
      FilterWarnings({{"a.jpg", {{FilterCriterion::kRange, 0.8}}}}, options),
      IsEmpty());
}

}  // namespace
}  // namespace hpm
