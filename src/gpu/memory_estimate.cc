#include "src/gpu/memory_estimate.h"

#include "src/core/geometric_term.h"

#include <algorithm>

namespace hpm {
namespace {

// Left to the driver, the display and other programs.
constexpr double kUsableShare = 0.9;

// Tables, events, and what alignment of arrays and textures costs.
constexpr uint64_t kOverheadBytes = 48ull << 20;

// NVIDIA's driver keeps a stack for every thread that can be resident. Bytes as
// ptxas tells for the update kernels (docs/benchmarks.md), rounded up.
constexpr uint64_t kStackBytes = 3584;
constexpr uint64_t kThreadsPerProcessor = 2048;

// Textures are stored in blocks; their rows and columns are rounded up.
constexpr uint64_t kTextureGrain = 128;

uint64_t RoundUp(uint64_t value, uint64_t grain) {
  return (value + grain - 1) / grain * grain;
}

uint64_t BytesPerTexel(ImageFormat format) {
  return format == ImageFormat::kQuad ? 4 : 1;
}

}  // namespace

uint64_t DeviceBytesNeeded(const ProblemSize& size, ImageFormat format) {
  const uint64_t pixels = static_cast<uint64_t>(size.width) * size.height;
  const uint64_t src_pixels =
      static_cast<uint64_t>(size.src_width) * size.src_height;
  const uint64_t layer = RoundUp(size.src_width, kTextureGrain) *
                         RoundUp(size.src_height, kTextureGrain) *
                         BytesPerTexel(format);
  // Priors of a level are halved once at least.
  const uint64_t low_priors = pixels / 4 * sizeof(Plane);
  // Plane, prior, cost, mask, and the filter's masks; visits.
  const uint64_t state =
      pixels * (2 * sizeof(Plane) + 3 * sizeof(uint32_t) + sizeof(uint8_t)) +
      low_priors;
  const uint64_t depths =
      size.geometric ? src_pixels * kInverseDepthBytes * size.num_srcs : 0;
  // One image on its way into a layer.
  const uint64_t staging = src_pixels + layer;
  return kOverheadBytes + state + pixels + layer * size.num_srcs + depths +
         staging;
}

uint64_t DeviceOverheadBytes(int num_processors) {
  return num_processors * kThreadsPerProcessor * kStackBytes;
}

int ImagesThatFit(const ProblemSize& size,
                  ImageFormat format,
                  uint64_t free_bytes,
                  int num_processors,
                  int most) {
  const auto usable =
      static_cast<uint64_t>(kUsableShare * static_cast<double>(free_bytes));
  const uint64_t overhead = DeviceOverheadBytes(num_processors);
  const uint64_t fit =
      usable > overhead ? (usable - overhead) / DeviceBytesNeeded(size, format)
                        : 0;
  return static_cast<int>(std::min<uint64_t>(fit, std::max(most, 0)));
}

}  // namespace hpm
