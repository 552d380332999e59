// Whole methods through the engine: priors that the backend upsamples, halved
// images, levels that are merged on the host between passes, mined regions,
// maps of all sources.
#pragma once

#include "src/cpu/cpu_backend.h"
#include "tests/engine/compare_maps.h"
#include "tests/engine/estimate.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {

// make(): a new backend.
template <class Make>
void ExpectWholeRunsOfTheScalarCpuBackend(const Make& make) {
  SceneOptions scene;
  scene.num_views = 3;
  scene.width = 43;
  scene.height = 32;
  const auto views = RenderViews(MakeScene("low_texture_wall", scene), 2);
  for (const char* method : {"hpm", "acmm", "hpm_plus"}) {
    ScheduleOptions options;
    options.method = method;
    options.num_levels = 2;
    options.num_iterations = 2;
    options.num_geom_iterations = 1;
    options.num_geom_passes = 2;
    RunSpec spec = SceneSpec(views, options);
    spec.filter = MapFilter{{0.1f, 0.05f, 1.0f, 2}};
    WorkerPool workers(make());
    WorkerPool cpu(MakeCpuBackend("scalar", 2));
    const auto a = EstimateScene(&workers, views, spec, 2);
    const auto b = EstimateScene(&cpu, views, spec, 2);
    for (int i = 0; i < 2; ++i) {
      EXPECT_TRUE(SameMaps(a[i], b[i])) << method << ", view " << i;
      const auto num_left = std::count_if(
          a[i].planes.begin(), a[i].planes.end(), [](const Plane& plane) {
            return plane.distance > 0;
          });
      EXPECT_GT(num_left, 50) << method << ", view " << i;
    }
  }
}

}  // namespace hpm
