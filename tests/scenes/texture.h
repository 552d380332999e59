// Solid texture: grey as a function of the point in space, so that every camera
// sees the same surface. A sum of waves in random directions whose lengths lie
// in a band; it has gradients nearly everywhere and little that could alias.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

namespace hpm {

struct TextureOptions {
  double shortest_wave = 0.1;  // world units
  double longest_wave = 0.4;
  double contrast = 36;  // standard deviation, grey values
  // Texture only in discs around the points of a square lattice in world x, y;
  // between them `plain_contrast` remains. 0: everywhere.
  double disc_spacing = 0;
  double disc_radius = 0;
  double plain_contrast = 0;
  // Balls around the points of a cubic lattice in place of the discs.
  bool balls = false;
  // Discs, and plain between them, from this world z on only; before it
  // texture is everywhere.
  double disc_beyond = -std::numeric_limits<double>::infinity();
  uint32_t seed = 1;
};

class Texture {
 public:
  explicit Texture(const TextureOptions& options);

  // About 128 +- contrast, not clamped.
  float Grey(const Eigen::Vector3f& point) const;

 private:
  static constexpr int kNumWaves = 16;

  float Contrast(const Eigen::Vector3f& point) const;

  TextureOptions options_;
  // Per wave: cycles per world unit along each axis, and phase in cycles.
  std::array<float, kNumWaves> x_, y_, z_, phase_;
};

}  // namespace hpm
