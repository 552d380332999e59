// What the sources of a problem say of the surfaces that the reference sees, by
// the depths that they found; see src/engine/view_propagation.h.
#pragma once

#include "src/base/cancel.h"
#include "src/core/limits.h"
#include "src/engine/landings_simd.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/weak_regions.h"

#include <cstdint>
#include <vector>

namespace hpm {

// What a source found.
class FoundSurface {
 public:
  FoundSurface(const ViewSet& views, const View& src);

  const SourcePose& pose() const { return pose_; }
  int width() const { return pose_.src.width; }
  int height() const { return pose_.src.height; }

  // 1/z in the source.
  float InverseDepth(int col, int row) const {
    const size_t at = static_cast<size_t>(row) * width() + col;
    return depths_.step * InverseDepthSteps(depths_.steps, at);
  }

  // In the frame of the reference; not within kReach of the border.
  Plane PlaneAt(int col, int row) const;

 private:
  InverseDepths depths_;
  SourcePose pose_;
};

// How many sources say the same of a cell.
struct Support {
  uint16_t first : 5;  // who said it first, an index of a surface
  uint16_t last : 5;
  uint16_t count : 6;  // 0: nobody
};
static_assert(kMaxViews <= 32);

// Depths other than the pixels' own that sources propose in a cell.
struct Proposals {
  static constexpr int kMax = 2;
  float inverse_depth[kMax];
  int32_t pixel[kMax];  // of the source that was first
  Support support[kMax];
};

// Votes on cells of the reference. In large images these have 2x2 pixels, and a
// source votes with every second pixel of every second row: the iterations that
// follow carry a plane on. In small ones every pixel counts.
class ViewVotes {
 public:
  // Pixels of `regions`, without texture, take no votes. Throws
  // Error(kInterrupted) once `cancel`, which may be null, is set.
  ViewVotes(const ViewSet& views,
            const WeakRegions& regions,
            const HypothesisMap& map,
            const CancelToken* cancel);

  int cell() const { return cell_; }          // pixels of a side
  int num_cols() const { return num_cols_; }  // of cells
  int num_rows() const { return num_rows_; }

  // The plane that most sources found in a cell, where these are more than
  // agree with the planes that its pixels have; distance 0 if there is none.
  Plane Winner(int cell_col, int cell_row) const;

 private:
  std::vector<FoundSurface> surfaces_;
  int cell_, num_cols_, num_rows_;
  std::vector<Support> own_;  // of the planes that the pixels have
  std::vector<Proposals> others_;
};

}  // namespace hpm
