// A tilted plane in four views of 96x72, depths of which the sources and the
// reference believe what a test gives them.
#pragma once

#include "tests/cpu/scene_views.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {

class PlaneInViews : public testing::Test {
 protected:
  static constexpr int kWidth = 96;
  static constexpr int kHeight = 72;

  PlaneInViews() : map_(kWidth, kHeight) {
    SceneOptions options;
    options.num_views = 4;
    options.width = kWidth;
    options.height = kHeight;
    rendered_ = RenderViews(MakeScene("tilted_plane", options), 1);
    views_ = AsViewSet(rendered_);
    AddTrueDepths(rendered_, 0, &views_);
  }

  // In source view j: the truth times `scale`.
  void SetDepth(size_t j, float scale) {
    std::vector<float> inverse;
    for (const float z : rendered_[j + 1].truth.depth)
      inverse.push_back(1 / (scale * z));
    views_.srcs[j].inverse_depth =
        std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
  }

  // In the reference: depths of the truth times `scale`.
  void SetMap(float scale, const std::vector<Vec3f>& normals) {
    for (int row = 0; row < kHeight; ++row) {
      for (int col = 0; col < kWidth; ++col) {
        const size_t at = static_cast<size_t>(row) * kWidth + col;
        map_.planes[at] = PlaneFromDepth(views_.ref.camera,
                                         static_cast<float>(col),
                                         static_cast<float>(row),
                                         scale * TrueDepth(at),
                                         normals[at]);
      }
    }
  }

  float TrueDepth(size_t at) const { return rendered_[0].truth.depth[at]; }
  const std::vector<Vec3f>& TrueNormals() const {
    return rendered_[0].truth.normals;
  }

  std::vector<RenderedView> rendered_;
  ViewSet views_;
  HypothesisMap map_;
};

}  // namespace hpm
