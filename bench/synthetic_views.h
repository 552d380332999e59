// A closed-form scene as problems for the benchmarks, rendered in parallel.
#pragma once

#include "src/engine/view.h"
#include "tests/scenes/render.h"

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace hpm {

struct SyntheticProblem {
  ViewSet photometric;  // the middle view and its num_srcs neighbours
  ViewSet geometric;    // the same with the sources' true depth
  RenderedView truth;   // of the reference
};

inline SyntheticProblem MakeSyntheticProblem(const std::string& scene,
                                             int width,
                                             int height,
                                             int num_srcs) {
  SceneOptions options;
  options.num_views = num_srcs + 1;
  options.width = width;
  options.height = height;
  const TestScene made = MakeScene(scene, options);
  std::vector<RenderedView> rendered(options.num_views);
  const int num_threads =
      std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::thread> threads;
  for (int t = 0; t < num_threads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = t; i < options.num_views; i += num_threads) {
        rendered[i] = RenderView(made, i, 1);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();

  SyntheticProblem problem;
  const int middle = options.num_views / 2;
  const auto as_view = [](const RenderedView& view) {
    return View{view.camera,
                std::make_shared<const GrayImage>(GrayImage{
                    view.camera.width, view.camera.height, view.grey}),
                nullptr};
  };
  ViewSet& views = problem.photometric;
  views.ref = as_view(rendered[middle]);
  problem.truth = rendered[middle];
  const auto [nearest, furthest] = std::minmax_element(
      problem.truth.truth.depth.begin(), problem.truth.truth.depth.end());
  views.depth_min = 0.7f * std::max(*nearest, 0.1f * *furthest);
  views.depth_max = 1.3f * *furthest;
  views.random_key = 1;
  for (int i = 0; i < options.num_views; ++i) {
    if (i != middle) views.srcs.push_back(as_view(rendered[i]));
  }
  problem.geometric = views;
  for (int i = 0, k = 0; i < options.num_views; ++i) {
    if (i == middle) continue;
    std::vector<float> inverse;
    inverse.reserve(rendered[i].truth.depth.size());
    for (const float z : rendered[i].truth.depth) {
      inverse.push_back(z > 0 ? 1 / z : 0);
    }
    problem.geometric.srcs[k++].inverse_depth =
        std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
  }
  return problem;
}

}  // namespace hpm
