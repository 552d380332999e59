#include "src/engine/view_votes.h"

#include "tests/cpu/scene_views.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

class ViewVotesTest : public testing::TestWithParam<int> {};

// Longer sides and the cells that go with them; odd, so that the last cells
// are cut.
INSTANTIATE_TEST_SUITE_P(Sides, ViewVotesTest, testing::Values(399, 1201));

TEST_P(ViewVotesTest, EveryCellHearsWhatTheSourcesFound) {
  SceneOptions options;
  options.num_views = 4;
  options.width = GetParam();
  options.height = 241;
  const auto rendered = RenderViews(MakeScene("sphere", options), 1);
  ViewSet views = AsViewSet(rendered);
  AddTrueDepths(rendered, 0, &views);
  WeakRegions regions;
  regions.width = options.width;
  regions.height = options.height;
  regions.label.assign(rendered[0].truth.depth.size(), 0);
  const int cell = options.width > 1000 ? 2 : 1;
  for (const float wrong : {1.5f, 1.0f}) {
    HypothesisMap map(options.width, options.height);
    for (size_t at = 0; at < map.planes.size(); ++at) {
      map.planes[at] = PlaneFromDepth(views.ref.camera,
                                      static_cast<float>(at % map.width),
                                      static_cast<float>(at / map.width),
                                      wrong * rendered[0].truth.depth[at],
                                      {0, 0, -1});
    }
    const ViewVotes votes(views, regions, map, nullptr);
    ASSERT_EQ(votes.cell(), cell);
    ASSERT_EQ(votes.num_cols(), (options.width + cell - 1) / cell);
    ASSERT_EQ(votes.num_rows(), (options.height + cell - 1) / cell);
    int num_won = 0, num_right = 0;
    for (int row = 0; row < votes.num_rows(); ++row) {
      for (int col = 0; col < votes.num_cols(); ++col) {
        const Plane winner = votes.Winner(col, row);
        if (!(winner.distance > 0)) continue;
        ++num_won;
        const int x = cell * col, y = cell * row;
        const float truth =
            rendered[0].truth.depth[static_cast<size_t>(y) * map.width + x];
        const float z = DepthAt(views.ref.camera,
                                winner,
                                static_cast<float>(x),
                                static_cast<float>(y));
        num_right += std::fabs(z - truth) < 0.002f * truth;
      }
    }
    if (wrong == 1) {
      EXPECT_LT(num_won, 0.02 * votes.num_cols() * votes.num_rows());
    } else {
      EXPECT_GT(num_won, 0.6 * votes.num_cols() * votes.num_rows());
      EXPECT_GT(num_right, 0.94 * num_won);  // but around the sphere's outline
    }
  }
}

}  // namespace
}  // namespace hpm
