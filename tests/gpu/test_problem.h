// What the tests of the CUDA backend run, with a card and without: the passes
// of a run, and views that show what tidy ones would hide.
#pragma once

#include "src/engine/pass.h"
#include "tests/cpu/scene_views.h"

#include <memory>
#include <string>
#include <vector>

namespace hpm {

inline const Pass kBasic = {PassKind::kBasic, StartFrom::kRandom, 3, 0};
inline const Pass kPrior = {PassKind::kPrior, StartFrom::kPrior, 2, 1};
inline const Pass kGeometric = {
    PassKind::kGeometric, StartFrom::kCurrent, 2, 2};

// Without the median.
inline Pass HalfSearch() {
  Pass pass = {PassKind::kBasic, StartFrom::kMissing, 3, 3, 0, false};
  pass.half_visits = true;
  return pass;
}

inline Pass HalfPass() {
  Pass pass = {PassKind::kGeometric, StartFrom::kCurrent, 2, 4};
  pass.half_visits = true;
  pass.few_views = true;
  pass.max_views = 2;
  return pass;
}

// One view is rolled.
inline std::vector<RenderedView> RenderTestViews(const std::string& scene,
                                                 int width,
                                                 int height) {
  SceneOptions options;
  options.num_views = 6;
  options.width = width;
  options.height = height;
  options.quarter_turns = {0, 0, 1, 0, 0, 0};
  return RenderViews(MakeScene(scene, options), 2);
}

// Their depth is the truth; one source has none, another is smaller and has
// none either.
inline ViewSet MakeTestViews(const std::vector<RenderedView>& rendered) {
  ViewSet views = AsViewSet(rendered);
  for (size_t j = 0; j < views.srcs.size(); ++j) {
    std::vector<float> inverse;
    for (const float z : rendered[j + 1].truth.depth) {
      inverse.push_back(z > 0 ? 1 / z : 0);
    }
    views.srcs[j].inverse_depth =
        std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
  }
  views.srcs[3].inverse_depth = nullptr;
  View& cropped = views.srcs[4];
  cropped = Cropped(
      cropped, 2, 1, cropped.camera.width - 5, cropped.camera.height - 3);
  cropped.inverse_depth = nullptr;
  return views;
}

}  // namespace hpm
