// The kernels of half-sweeps: 32 pixels of one colour per warp, two warps per
// block. Included by one .cu file per sampler, so that they compile in
// parallel.
#pragma once

#include "cuda/check.h"
#include "cuda/lane_cost.h"
#include "cuda/launch.h"
#include "cuda/pixel_kernels.h"

namespace hpm {

#if !defined(HPM_WARPS_PER_BLOCK)
#define HPM_WARPS_PER_BLOCK 2
#endif
constexpr int kWarpsPerBlock = HPM_WARPS_PER_BLOCK;
// At most 128 registers per thread. The benchmark compares other numbers.
#if !defined(HPM_BLOCKS_PER_PROCESSOR)
#define HPM_BLOCKS_PER_PROCESSOR 6
#endif
constexpr int kBlocksPerProcessor = HPM_BLOCKS_PER_PROCESSOR;

// The windows of the pixels of a warp.
struct WarpWindows {
  WindowSample samples[kPatchSize][kWarpSize];
};

__device__ inline void CountEvaluations(int evaluations,
                                        int lane,
                                        unsigned long long* total) {
  for (int step = kWarpSize / 2; step > 0; step /= 2) {
    evaluations += __shfl_down_sync(0xFFFFFFFFu, evaluations, step);
  }
  if (lane == 0) {
    atomicAdd(total, static_cast<unsigned long long>(evaluations));
  }
}

template <SweepKind kKind, class Sampler>
__global__ void __launch_bounds__(kWarpsPerBlock* kWarpSize,
                                  kBlocksPerProcessor)
    SweepKernel(const __grid_constant__ DeviceProblem problem,
                const __grid_constant__ Sweep sweep,
                const PixelState state,
                uint32_t* consistent,
                const Band band,
                unsigned long long* num_evaluations) {
  __shared__ WarpWindows windows[kWarpsPerBlock];
  const int lane = threadIdx.x % kWarpSize;
  const int64_t warp = static_cast<int64_t>(blockIdx.x) * kWarpsPerBlock +
                       threadIdx.x / kWarpSize;
  if (warp >= band.num_warps()) return;
  const Pixel pixel = PixelOf(band, warp, lane);
  int evaluations = 0;
  if (pixel.inside) {
    WindowSample* samples = &windows[threadIdx.x / kWarpSize].samples[0][lane];
    const RefPatch patch = RefPatchAt(problem, pixel.col, pixel.row);
    StoreWindow(patch, samples, kWarpSize);
    const Window window = {
        samples, kWarpSize, patch.center, patch.mean, patch.variance};
    const LaneCost<Sampler> cost(problem, window, pixel.col, pixel.row);
    VisitPixel<kKind>(
        problem, sweep, state, consistent, cost, pixel.col, pixel.row);
    evaluations = cost.num_evaluations();
  }
  __syncwarp();
  CountEvaluations(evaluations, lane, num_evaluations);
}

// The costs of each pixel's own plane in all views, for tests:
// costs[pixel * num_views + view].
template <class Sampler>
__global__ void __launch_bounds__(kWarpsPerBlock* kWarpSize)
    CostsOfPlanes(const __grid_constant__ DeviceProblem problem,
                  const PixelState state,
                  const Band band,
                  float* costs) {
  __shared__ WarpWindows windows[kWarpsPerBlock];
  const int lane = threadIdx.x % kWarpSize;
  const int64_t warp = static_cast<int64_t>(blockIdx.x) * kWarpsPerBlock +
                       threadIdx.x / kWarpSize;
  if (warp >= band.num_warps()) return;
  const Pixel pixel = PixelOf(band, warp, lane);
  if (!pixel.inside) return;
  WindowSample* samples = &windows[threadIdx.x / kWarpSize].samples[0][lane];
  const RefPatch patch = RefPatchAt(problem, pixel.col, pixel.row);
  StoreWindow(patch, samples, kWarpSize);
  const Window window = {
      samples, kWarpSize, patch.center, patch.mean, patch.variance};
  const LaneCost<Sampler> cost(problem, window, pixel.col, pixel.row);
  const size_t at = static_cast<size_t>(pixel.row) * state.width + pixel.col;
  const Plane plane = state.planes[at];
  for (int view = 0; view < problem.params.num_views; ++view) {
    const uint8_t views[1] = {static_cast<uint8_t>(view)};
    cost.Photometric(
        &plane, 1, views, 1, &costs[at * problem.params.num_views + view]);
  }
}

template <class Sampler>
void LaunchSweepWith(const SweepLaunch& launch, cudaStream_t stream) {
  const unsigned blocks = static_cast<unsigned>(
      (launch.band.num_warps() + kWarpsPerBlock - 1) / kWarpsPerBlock);
  const auto start = [&](auto* kernel) {
    kernel<<<blocks, kWarpsPerBlock * kWarpSize, 0, stream>>>(
        *launch.problem,
        launch.sweep,
        launch.state,
        launch.consistent,
        launch.band,
        launch.num_evaluations);
    CheckCuda(cudaGetLastError(), "starting a kernel");
  };
  switch (launch.sweep.kind) {
    case SweepKind::kInitialize:
      start(&SweepKernel<SweepKind::kInitialize, Sampler>);
      break;
    case SweepKind::kUpdate:
      start(&SweepKernel<SweepKind::kUpdate, Sampler>);
      break;
    case SweepKind::kConsistency:
      start(&SweepKernel<SweepKind::kConsistency, Sampler>);
      break;
    case SweepKind::kFollow:
      LaunchFollow(launch, stream);
      break;
    case SweepKind::kMedian:
      LaunchMedian(launch, stream);
      break;
  }
}

template <class Sampler>
void LaunchCostsWith(const SweepLaunch& launch,
                     float* costs,
                     cudaStream_t stream) {
  const unsigned blocks = static_cast<unsigned>(
      (launch.band.num_warps() + kWarpsPerBlock - 1) / kWarpsPerBlock);
  CostsOfPlanes<Sampler><<<blocks, kWarpsPerBlock * kWarpSize, 0, stream>>>(
      *launch.problem, launch.state, launch.band, costs);
  CheckCuda(cudaGetLastError(), "starting a kernel");
}

}  // namespace hpm
