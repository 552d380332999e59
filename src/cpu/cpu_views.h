// The images of one problem in the layout of the CPU's cost functions, and the
// Cost object of a pixel visit (see src/core/visit.h).
#pragma once

#include "src/base/huge_pages.h"
#include "src/core/geometric_term.h"
#include "src/cpu/match_cost.h"
#include "src/cpu/texel_image.h"
#include "src/engine/pass.h"
#include "src/engine/view.h"

#include <memory>
#include <vector>

namespace hpm {

class CpuViews {
 public:
  CpuViews(const ViewSet& views, const MethodParams& params);

  const MatchViews& match() const { return match_; }
  int num_views() const { return match_.num_views; }
  // Camera centre of a source view in the reference camera frame.
  const std::vector<Vec3f>& src_centers() const { return src_centers_; }

  bool HasDepth(int view) const { return inverse_depths_[view] != nullptr; }

  RefPatch PatchAt(int col, int row) const;
  float GeometricError(const PlaneSlope& slope,
                       int view,
                       float col,
                       float row,
                       float max_error) const;

  // Bytes for one reference of this size.
  static uint64_t MemoryNeeded(int width, int height, int num_srcs);

 private:
  int padding_;  // of the reference image, on each side
  int padded_width_;
  std::vector<uint8_t> padded_ref_;
  float color_weights_[256];
  std::vector<Texel, HugePageAllocator<Texel>> texels_;
  MatchViews match_;
  std::vector<ViewWarp> to_src_, to_ref_;
  std::vector<std::shared_ptr<const InverseDepthMap>> inverse_depths_;
  std::vector<Vec3f> src_centers_;
};

class CpuPixelCost {
 public:
  CpuPixelCost(const CpuViews& views,
               MatchCostFunction match_cost,
               float max_geometric_error,
               int col,
               int row)
      : views_(views),
        match_cost_(match_cost),
        max_geometric_error_(max_geometric_error),
        patch_(views.PatchAt(col, row)),
        col_(col),
        row_(row) {}

  void Photometric(const Plane* planes,
                   int num_planes,
                   const uint8_t* views,
                   int num_views,
                   float* costs) const {
    const MatchRequest request = {
        col_, row_, planes, num_planes, views, num_views};
    match_cost_(views_.match(), patch_, request, costs);
    num_evaluations_ += static_cast<uint64_t>(request.num_pairs());
  }

  bool HasDepth(int view) const { return views_.HasDepth(view); }

  float GeometricError(const PlaneSlope& slope, int view) const {
    return views_.GeometricError(slope,
                                 view,
                                 static_cast<float>(col_),
                                 static_cast<float>(row_),
                                 max_geometric_error_);
  }

  uint64_t num_evaluations() const { return num_evaluations_; }

 private:
  const CpuViews& views_;
  MatchCostFunction match_cost_;
  float max_geometric_error_;
  RefPatch patch_;
  int col_, row_;
  mutable uint64_t num_evaluations_ = 0;
};

}  // namespace hpm
