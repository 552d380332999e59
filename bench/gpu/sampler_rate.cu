#include "bench/gpu/sampler_rate.h"
#include "cuda/check.h"
#include "cuda/device_images.h"
#include "cuda/device_memory.h"
#include "cuda/warp.h"
#include "src/gpu/problem_tables.h"

#include <algorithm>
#include <vector>

namespace hpm {
namespace {

constexpr int kBlock = 64;
constexpr int kWindows = 16;  // per thread

template <class Sampler>
__global__ void Sample(const __grid_constant__ DeviceProblem problem,
                       const Band band,
                       float spread,
                       float* sums) {
  const int lane = threadIdx.x % kWarpSize;
  const int64_t warp = static_cast<int64_t>(blockIdx.x) * (kBlock / kWarpSize) +
                       threadIdx.x / kWarpSize;
  if (warp >= band.num_warps()) return;
  const Pixel pixel = PixelOf(band, warp, lane);
  const Sampler sampler(problem);
  float sum = 0;
  for (int window = 0; window < kWindows; ++window) {
    const int view = window % problem.params.num_views;
    const ViewGeometry& geometry = problem.views[view];
    const float col = 0.5f * spread * pixel.col + 0.37f * window;
    const float row = 0.5f * spread * pixel.row + 0.21f * window;
    const float u = fmodf(col, geometry.max_u), v = fmodf(row, geometry.max_v);
#pragma unroll
    for (int j = 0; j < kPatchAxis; ++j) {
#pragma unroll
      for (int i = 0; i < kPatchAxis; ++i) {
        sum += sampler(geometry, view, u + 2.03f * i, v + 1.97f * j);
      }
    }
  }
  sums[static_cast<size_t>(blockIdx.x) * kBlock + threadIdx.x] = sum;
}

}  // namespace

double MeasureSampleRate(const ViewSet& views,
                         ImageFormat format,
                         int log_tile_width,
                         float spread) {
  DeviceImages images(format);
  Uploader uploader(nullptr);
  images.Upload(views, &uploader);
  ProblemTables tables = MakeProblemTables(views, MethodParams());
  for (size_t j = 0; j < views.srcs.size(); ++j) {
    tables.views[j].texels = images.texels(static_cast<int>(j));
  }
  DeviceBuffer<ViewGeometry> geometry;
  geometry.Upload(tables.views, &uploader);
  tables.problem.views = geometry.data();
  tables.problem.texture = images.texture();
  const Camera& ref = views.ref.camera;
  const Band band = {ref.width, ref.height, 0, ref.height, 0, log_tile_width};
  const unsigned blocks = static_cast<unsigned>(
      (band.num_warps() * kWarpSize + kBlock - 1) / kBlock);
  DeviceBuffer<float> sums;
  sums.Reserve(static_cast<size_t>(blocks) * kBlock);
  cudaEvent_t events[2];
  for (cudaEvent_t& event : events) {
    CheckCuda(cudaEventCreate(&event), "making an event");
  }
  std::vector<float> milliseconds;
  for (int repeat = 0; repeat < 7; ++repeat) {
    CheckCuda(cudaEventRecord(events[0]), "timing");
    if (format == ImageFormat::kQuad) {
      Sample<QuadSampler>
          <<<blocks, kBlock>>>(tables.problem, band, spread, sums.data());
    } else {
      Sample<TextureSampler>
          <<<blocks, kBlock>>>(tables.problem, band, spread, sums.data());
    }
    CheckCuda(cudaGetLastError(), "sampling");
    CheckCuda(cudaEventRecord(events[1]), "timing");
    CheckCuda(cudaEventSynchronize(events[1]), "sampling");
    float taken = 0;
    CheckCuda(cudaEventElapsedTime(&taken, events[0], events[1]), "timing");
    if (repeat > 1) milliseconds.push_back(taken);
  }
  for (cudaEvent_t event : events) cudaEventDestroy(event);
  std::sort(milliseconds.begin(), milliseconds.end());
  const double seconds = 1e-3 * milliseconds[milliseconds.size() / 2];
  return static_cast<double>(band.num_warps()) * kWarpSize * kWindows *
         kPatchSize / seconds;
}

}  // namespace hpm
