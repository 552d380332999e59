#include "src/engine/view_propagation.h"

#include "src/engine/view_votes.h"

#include <algorithm>
#include <vector>

namespace hpm {
namespace {

// Of the mean cost of a plane's best views.
constexpr float kMatches = 0.6f;  // where more, the images do not match
constexpr float kMargin = 0.05f;  // ties say nothing

// The plane for the textured pixels of a cell that may have it.
void AddProposals(const ViewSet& views,
                  const WeakRegions& regions,
                  const Plane& plane,
                  int first_col,
                  int first_row,
                  int cell,
                  std::vector<PixelPlane>* proposed) {
  const int end_col = std::min(first_col + cell, regions.width);
  const int end_row = std::min(first_row + cell, regions.height);
  for (int row = first_row; row < end_row; ++row) {
    for (int col = first_col; col < end_col; ++col) {
      if (regions.At(col, row) > 0) continue;
      const float z = DepthAt(views.ref.camera,
                              plane,
                              static_cast<float>(col),
                              static_cast<float>(row));
      if (z >= views.depth_min && z <= views.depth_max)
        proposed->push_back({col, row, plane});
    }
  }
}

// Takes those of the planes that match, and do so better than what the pixels
// have.
void TakeBetter(const ScorePlanes& score,
                std::vector<PixelPlane>* proposed,
                HypothesisMap* map) {
  if (proposed->empty()) return;
  const auto plane_of = [&](const PixelPlane& pixel) -> Plane& {
    return map->planes[static_cast<size_t>(pixel.row) * map->width + pixel.col];
  };
  const std::vector<float> costs = score(*proposed);
  std::vector<size_t> matching;
  std::vector<PixelPlane> own;
  for (size_t i = 0; i < costs.size(); ++i) {
    if (!(costs[i] < kMatches)) continue;
    const PixelPlane& pixel = (*proposed)[i];
    matching.push_back(i);
    own.push_back({pixel.col, pixel.row, plane_of(pixel)});
  }
  const std::vector<float> own_costs = score(own);
  for (size_t k = 0; k < own.size(); ++k) {
    const size_t i = matching[k];
    if (costs[i] + kMargin < own_costs[k])
      plane_of(own[k]) = (*proposed)[i].plane;
  }
  proposed->clear();
}

}  // namespace

void PropagateViews(const ViewSet& views,
                    const WeakRegions& regions,
                    const ScorePlanes& score,
                    const CancelToken* cancel,
                    HypothesisMap* map) {
  constexpr size_t kAskedAtOnce = 1 << 16;
  const ViewVotes votes(views, regions, *map, cancel);
  std::vector<PixelPlane> proposed;
  for (int row = 0; row < votes.num_rows(); ++row) {
    for (int col = 0; col < votes.num_cols(); ++col) {
      const Plane plane = votes.Winner(col, row);
      if (!(plane.distance > 0)) continue;
      AddProposals(views,
                   regions,
                   plane,
                   votes.cell() * col,
                   votes.cell() * row,
                   votes.cell(),
                   &proposed);
      if (proposed.size() >= kAskedAtOnce) TakeBetter(score, &proposed, map);
    }
  }
  TakeBetter(score, &proposed, map);
  map->Touch();
}

}  // namespace hpm
