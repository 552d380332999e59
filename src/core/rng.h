// Counter-based random numbers: a stream is a hash of what it is for, so the
// same seed gives the same numbers on any backend, thread count or resume.
#pragma once

#include "src/core/host_device.h"

#include <stdint.h>

namespace hpm {

// SplitMix64 finaliser (Steele, Lea, Flood 2014; public domain constants).
HPM_HD uint64_t MixBits(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

HPM_HD uint64_t CombineBits(uint64_t key, uint64_t value) {
  return MixBits(key ^
                 (value + 0x9E3779B97F4A7C15ull + (key << 6) + (key >> 2)));
}

class Rng {
 public:
  // `key` identifies (seed, image, pass, iteration); one stream per pixel of
  // it.
  HPM_HD_MEMBER Rng(uint64_t key, int col, int row)
      : state_(CombineBits(
            key,
            (static_cast<uint64_t>(row) << 32) | static_cast<uint32_t>(col))) {}

  // Uniform in [0, 1).
  HPM_HD_MEMBER float Uniform() {
    state_ += 0x9E3779B97F4A7C15ull;
    return static_cast<float>(MixBits(state_) >> 40) * (1.0f / 16777216.0f);
  }

  // Uniform in [lo, hi), up to rounding.
  HPM_HD_MEMBER float Uniform(float lo, float hi) {
    return lo + (hi - lo) * Uniform();
  }

 private:
  uint64_t state_;
};

}  // namespace hpm
