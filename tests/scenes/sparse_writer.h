// The sparse model of a test scene in COLMAP's binary layout.
#pragma once

#include "tests/scenes/scene.h"

#include <filesystem>
#include <vector>

namespace hpm {

struct Observation {
  int view;
  double x, y;  // pixels, centre of pixel (col, row) at (col + 0.5, row + 0.5)
};

struct TrackedPoint {
  Eigen::Vector3d xyz;
  std::vector<Observation> track;
};

// Points under a grid of pixels of every view, each with all views that truly
// see it (at least two). About `per_view` candidates per view.
std::vector<TrackedPoint> SampleSurface(const TestScene& scene, int per_view);

// cameras.bin, images.bin, points3D.bin: one PINHOLE camera per view, ids
// from 1.
void WriteSparseModel(const std::filesystem::path& folder,
                      const std::vector<Camera>& cameras,
                      const std::vector<std::string>& names,
                      const std::vector<TrackedPoint>& points);

}  // namespace hpm
