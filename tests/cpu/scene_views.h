// View sets from rendered scenes, and hypotheses around the truth.
#pragma once

#include "src/engine/view.h"
#include "tests/scenes/render.h"

#include <algorithm>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace hpm {

inline View AsView(const RenderedView& rendered) {
  return {rendered.camera,
          std::make_shared<const GrayImage>(GrayImage{
              rendered.camera.width, rendered.camera.height, rendered.grey}),
          nullptr};
}

// The first view is the reference; its true depths set the range.
inline ViewSet AsViewSet(const std::vector<RenderedView>& views) {
  ViewSet set;
  set.ref = AsView(views[0]);
  for (size_t i = 1; i < views.size(); ++i) {
    set.srcs.push_back(AsView(views[i]));
  }
  const auto [nearest, furthest] = std::minmax_element(
      views[0].truth.depth.begin(), views[0].truth.depth.end());
  set.depth_min = 0.7f * *nearest;
  set.depth_max = 1.4f * *furthest;
  set.random_key = 42;
  return set;
}

// The true depths of the sources from number `first` on.
inline void AddTrueDepths(const std::vector<RenderedView>& rendered,
                          size_t first,
                          ViewSet* set) {
  for (size_t j = first; j < set->srcs.size(); ++j) {
    std::vector<float> inverse;
    for (const float z : rendered[j + 1].truth.depth) inverse.push_back(1 / z);
    set->srcs[j].inverse_depth =
        std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
  }
}

// The view with what lies left of `col` masked.
inline View WithGap(const View& view, int col) {
  View masked = view;
  GrayImage image = *view.image;
  image.has_gaps = true;
  for (int row = 0; row < image.height; ++row) {
    for (int c = 0; c < image.width; ++c) {
      uint8_t& value = image.data[static_cast<size_t>(row) * image.width + c];
      value = c < col ? 0 : std::max<uint8_t>(value, 1);
    }
  }
  masked.image = std::make_shared<const GrayImage>(std::move(image));
  return masked;
}

// The part of a view from (col, row) on, as a camera of its own.
inline View Cropped(const View& view, int col, int row, int width, int height) {
  View part = view;
  part.camera.width = width;
  part.camera.height = height;
  part.camera.cx -= static_cast<float>(col);
  part.camera.cy -= static_cast<float>(row);
  GrayImage image{width, height, {}};
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      image.data.push_back(view.image->at(col + c, row + r));
    }
  }
  part.image = std::make_shared<const GrayImage>(std::move(image));
  return part;
}

// Some on the surface, some beside it, some far off or nonsense.
inline Plane SomeHypothesis(const RenderedView& ref,
                            int col,
                            int row,
                            std::mt19937* random) {
  const auto uniform = [&](float lo, float hi) {
    return lo + (hi - lo) * static_cast<float>((*random)() / 4294967296.0);
  };
  const size_t at = static_cast<size_t>(row) * ref.camera.width + col;
  float depth = ref.truth.depth[at];
  Vec3f normal = ref.truth.normals[at];
  switch ((*random)() % 5) {
    case 0:
      break;
    case 1:
      depth *= uniform(0.98f, 1.02f);
      break;
    case 2:
      depth *= uniform(0.3f, 3.0f);
      normal = Normalized({uniform(-1, 1), uniform(-1, 1), -1});
      break;
    case 3:  // nearly along the ray
      normal = Normalized({1, uniform(-1, 1), uniform(-0.01f, 0.01f)});
      break;
    case 4:  // behind or at the source cameras
      depth *= uniform(-1.0f, 0.01f);
      break;
  }
  return PlaneFromDepth(ref.camera,
                        static_cast<float>(col),
                        static_cast<float>(row),
                        depth,
                        normal);
}

}  // namespace hpm
