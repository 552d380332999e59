// The images of one problem in the layout of the CPU's cost functions, and the
// Cost object of a pixel visit (see src/core/visit.h).
#pragma once

#include "src/base/huge_pages.h"
#include "src/cpu/cpu_target.h"
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

  bool HasDepth(int view) const { return depth_views_[view].HasDepth(); }
  const DepthView* depth_views() const { return depth_views_.data(); }

  RefPatch PatchAt(int col, int row) const;

  // Bytes for one reference of this size.
  static uint64_t MemoryNeeded(int width, int height, int num_srcs);

 private:
  int padding_;  // of the reference image, on each side
  int padded_width_;
  std::vector<uint8_t> padded_ref_;
  float color_weights_[2][256];  // of unmixed and of mixed windows
  std::vector<Texel, HugePageAllocator<Texel>> texels_;
  MatchViews match_;
  std::vector<DepthView> depth_views_;
  std::vector<std::shared_ptr<const InverseDepthMap>>
      inverse_depths_;  // owners
  std::vector<Vec3f> src_centers_;
};

// What a visit asks of the sources' depth maps, at one pixel.
class CpuPixelErrors {
 public:
  CpuPixelErrors(const CpuViews& views,
                 const CpuTarget& target,
                 float max_geometric_error,
                 int col,
                 int row)
      : views_(views),
        geometric_errors_(target.geometric_errors),
        max_geometric_error_(max_geometric_error),
        col_(col),
        row_(row) {}

  bool HasDepth(int view) const { return views_.HasDepth(view); }

  void GeometricErrors(const Plane* planes,
                       int num_planes,
                       const uint8_t* views,
                       int num_views,
                       float* errors) const {
    geometric_errors_(views_.match().ref,
                      views_.depth_views(),
                      max_geometric_error_,
                      {col_, row_, planes, num_planes, views, num_views},
                      errors);
  }

 protected:
  const CpuViews& views_;
  GeometricErrorFunction geometric_errors_;
  float max_geometric_error_;
  int col_, row_;
};

// Asks for the costs of one pixel alone; where many are visited see
// pixel_group.h.
class CpuPixelCost : public CpuPixelErrors {
 public:
  CpuPixelCost(const CpuViews& views,
               const CpuTarget& target,
               float max_geometric_error,
               int col,
               int row)
      : CpuPixelErrors(views, target, max_geometric_error, col, row),
        match_costs_(target.match_costs) {
    patches_.Set(0, views.PatchAt(col, row));
  }

  void Photometric(const Plane* planes,
                   int num_planes,
                   const uint8_t* views,
                   int num_views,
                   float* costs) const {
    const MatchRequest request = {
        {col_, row_, planes, num_planes, views, num_views}, 0, costs};
    match_costs_(views_.match(), patches_, &request, 1);
    num_evaluations_ += static_cast<uint64_t>(request.asked.num_pairs());
  }

  uint64_t num_evaluations() const { return num_evaluations_; }

 private:
  MatchCostFunction match_costs_;
  RefPatches patches_;
  mutable uint64_t num_evaluations_ = 0;
};

}  // namespace hpm
