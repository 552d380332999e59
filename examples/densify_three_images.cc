// Depth maps of three images in memory: no workspace, no files. Pictures of
// your own come from LoadGrayImage() (src/image/load_image.h) or any decoder;
// integer (col, row) is the centre of a pixel.
#include "src/cpu/cpu_backend.h"
#include "src/engine/memory_stores.h"
#include "src/engine/run_schedule.h"

#include <cmath>
#include <cstdio>

int main() {
  // Three photographs of a painted wall 4 m away, taken side by side.
  constexpr int kWidth = 160, kHeight = 120;
  constexpr float kFocal = 150, kWall = 4, kStep = 0.3f;
  std::vector<hpm::Camera> cameras;
  std::vector<hpm::GrayImage> pictures;
  for (int i = 0; i < 3; ++i) {
    const float left = kStep * static_cast<float>(i);
    cameras.push_back({kWidth,
                       kHeight,
                       kFocal,
                       kFocal,
                       79.5f,
                       59.5f,
                       {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
                       {-left, 0, 0}});
    pictures.push_back({kWidth, kHeight, {}});
    for (int row = 0; row < kHeight; ++row) {
      for (int col = 0; col < kWidth; ++col) {
        const float x =
            (static_cast<float>(col) - 79.5f) * kWall / kFocal + left;
        const float y = (static_cast<float>(row) - 59.5f) * kWall / kFocal;
        const float paint = std::sin(17 * x + 3 * std::sin(5 * y)) +
                            std::sin(13 * y + 3 * std::sin(7 * x));
        pictures.back().data.push_back(static_cast<uint8_t>(128 + 60 * paint));
      }
    }
  }

  // Each image is matched against the two others.
  hpm::RunSpec run = hpm::DefaultRunSpec("hpm_plus", kWidth);
  for (int i = 0; i < 3; ++i) {
    hpm::Problem problem;
    problem.image = i;
    problem.camera = cameras[i];
    for (const int j : {(i + 1) % 3, (i + 2) % 3})
      problem.sources.push_back({j, cameras[j]});
    problem.depth_min = 1;
    problem.depth_max = 10;
    problem.random_key = i;
    run.problems.push_back(problem);
  }
  hpm::MemoryImageStore images(pictures);
  hpm::MemoryMapStore maps(run.problems);
  hpm::WorkerPool workers(hpm::MakeCpuBackend("auto", 0));
  hpm::RunSchedule(run, &images, &maps, &workers, {});

  const hpm::HypothesisMap& map = *maps.map(0);
  int num_right = 0;
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const float z = hpm::DepthAt(cameras[0],
                                   map.planes[row * kWidth + col],
                                   static_cast<float>(col),
                                   static_cast<float>(row));
      num_right += std::abs(z - kWall) < 0.01f * kWall;
    }
  }
  const double share = num_right / static_cast<double>(kWidth * kHeight);
  std::printf("%.1f %% of the pixels within 1 %% of the wall\n", 100 * share);
  return share > 0.9 ? 0 : 1;
}
