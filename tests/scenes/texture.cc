#include "tests/scenes/texture.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace hpm {
namespace {

// Sine of `cycles` turns, made of two parabolas (third harmonic 4 %): cheap and
// easy for the compiler to vectorise.
inline float Wave(float cycles) {
  const float shifted =
      cycles + 4096.0f;  // positive, so that truncation is floor
  const float t =
      2 * (shifted - static_cast<float>(static_cast<int>(shifted))) - 1;
  return 4 * t * (std::abs(t) - 1);
}

// Uniform in [0, 1); the standard distributions differ between libraries.
double Uniform(std::mt19937& generator) { return generator() / 4294967296.0; }

}  // namespace

Texture::Texture(const TextureOptions& options) : options_(options) {
  std::mt19937 generator(options.seed);
  for (int i = 0; i < kNumWaves; ++i) {
    const double z = 2 * Uniform(generator) - 1;
    const double angle = 2 * M_PI * Uniform(generator);
    const double length = options.shortest_wave *
                          std::pow(options.longest_wave / options.shortest_wave,
                                   Uniform(generator));
    const double across = std::sqrt(1 - z * z);
    x_[i] = static_cast<float>(across * std::cos(angle) / length);
    y_[i] = static_cast<float>(across * std::sin(angle) / length);
    z_[i] = static_cast<float>(z / length);
    phase_[i] = static_cast<float>(Uniform(generator));
  }
}

float Texture::Grey(const Eigen::Vector3f& point) const {
  const float px = point.x(), py = point.y(), pz = point.z();
  float sum = 0;
  for (int i = 0; i < kNumWaves; ++i) {
    sum += Wave(x_[i] * px + y_[i] * py + z_[i] * pz + phase_[i]);
  }
  // A parabolic wave has variance 8/15.
  const float scale = 1.0f / std::sqrt(kNumWaves * 8.0f / 15.0f);
  return 128.0f + Contrast(point) * scale * sum;
}

float Texture::Contrast(const Eigen::Vector3f& point) const {
  const auto contrast = static_cast<float>(options_.contrast);
  if (options_.disc_spacing <= 0 || point.z() < options_.disc_beyond)
    return contrast;
  const auto spacing = static_cast<float>(options_.disc_spacing);
  const auto radius = static_cast<float>(options_.disc_radius);
  const float dx = point.x() - spacing * std::round(point.x() / spacing);
  const float dy = point.y() - spacing * std::round(point.y() / spacing);
  const float dz = options_.balls
                       ? point.z() - spacing * std::round(point.z() / spacing)
                       : 0;
  // Fades over the outer fifth of the disc.
  const float inside = std::clamp(
      5 * (1 - std::sqrt(dx * dx + dy * dy + dz * dz) / radius), 0.0f, 1.0f);
  const auto plain = static_cast<float>(options_.plain_contrast);
  return plain + (contrast - plain) * inside;
}

}  // namespace hpm
