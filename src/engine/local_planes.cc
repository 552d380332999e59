#include "src/engine/local_planes.h"

#include "src/engine/local_planes_simd.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr float kSigmaSpatial = 1.8f;  // pixels
constexpr float kSigmaGrey = 10;       // grey levels
constexpr int kRowsPerTask = 16;

struct Weights {
  std::array<float, 256> grey;
  float spatial[kFitSide][kFitSide];

  Weights() {
    for (int d = 0; d < 256; ++d) {
      grey[d] =
          std::exp(-static_cast<float>(d * d) / (2 * kSigmaGrey * kSigmaGrey));
    }
    for (int r = -kFitRadius; r <= kFitRadius; ++r) {
      for (int c = -kFitRadius; c <= kFitRadius; ++c) {
        spatial[r + kFitRadius][c + kFitRadius] =
            std::exp(-static_cast<float>(r * r + c * c) /
                     (2 * kSigmaSpatial * kSigmaSpatial));
      }
    }
  }
};

// A row-major array with room beside the rows, as FitRow() wants it.
template <class T>
class Padded {
 public:
  Padded(int first_row, int num_rows, int width)
      : first_row_(first_row),
        stride_(kFitLeft + width + kFitRight),
        entries_(new T[num_rows * stride_]) {}  // not yet touched

  ptrdiff_t stride() const { return stride_; }
  T* Row(int row) const {
    return entries_.get() + (row - first_row_) * stride_ + kFitLeft;
  }
  void ClearBeside(int row) {
    std::fill_n(Row(row) - kFitLeft, kFitLeft, T{0});
    std::fill_n(Row(row + 1) - kFitLeft - kFitRight, kFitRight, T{0});
  }

 private:
  int first_row_;
  ptrdiff_t stride_;
  std::unique_ptr<T[]> entries_;
};

Padded<float> InverseDepthsOf(const Camera& camera, const HypothesisMap& map) {
  Padded<float> result(0, map.height, map.width);
  tbb::parallel_for(0, map.height, [&](int row) {
    result.ClearBeside(row);
    float* inverse_depths = result.Row(row);
    const Plane* planes = &map.planes[static_cast<size_t>(row) * map.width];
    for (int col = 0; col < map.width; ++col) {
      const float z = DepthAt(camera,
                              planes[col],
                              static_cast<float>(col),
                              static_cast<float>(row));
      inverse_depths[col] = planes[col].distance > 0 && z > 0 ? 1 / z : 0;
    }
  });
  return result;
}

}  // namespace

void FitLocalPlanes(const Camera& camera,
                    const GrayImage& image,
                    float tolerance,
                    const PriorRange& range,
                    HypothesisMap* map) {
  const Weights weights;
  const Padded<float> inverse_depths = InverseDepthsOf(camera, *map);
  const int width = map->width, height = map->height;
  tbb::parallel_for(
      tbb::blocked_range<int>(0, height, kRowsPerTask), [&](const auto& rows) {
        const int first = std::max(0, rows.begin() - kFitRadius);
        const int end = std::min(height, rows.end() + kFitRadius);
        Padded<uint8_t> grey(first, end - first, width);
        for (int row = first; row < end; ++row) {
          grey.ClearBeside(row);
          const auto from = static_cast<ptrdiff_t>(row) * width;
          std::copy_n(image.data.begin() + from, width, grey.Row(row));
        }
        for (int row = rows.begin(); row < rows.end(); ++row) {
          FitRow({&camera,
                  tolerance,
                  range,
                  row,
                  width,
                  std::max(-kFitRadius, -row),
                  std::min(kFitRadius, height - 1 - row),
                  inverse_depths.Row(row),
                  inverse_depths.stride(),
                  grey.Row(row),
                  grey.stride(),
                  weights.grey.data(),
                  weights.spatial},
                 &map->planes[static_cast<size_t>(row) * width]);
        }
      });
  map->Touch();
}

}  // namespace hpm
