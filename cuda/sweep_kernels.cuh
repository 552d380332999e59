// The kernels of half-sweeps: 32 pixels of one colour per warp, two warps per
// block. Included by one .cu file per sampler, so that they compile in
// parallel.
#pragma once

#include "cuda/check.h"
#include "cuda/launch.h"
#include "cuda/launch_shape.h"
#include "src/gpu/lane_cost.h"

namespace hpm {

// The windows of the pixels of a warp.
struct WarpWindows {
  WindowSample samples[kPatchSize][kWarpSize];
};

// Puts the window of this lane's pixel among those of its warp.
__device__ inline Window WindowAt(const DeviceProblem& problem,
                                  WarpWindows* windows,
                                  int col,
                                  int row) {
  WindowSample* samples = &windows->samples[0][threadIdx.x % kWarpSize];
  const RefPatch patch = RefPatchAt(problem, col, row);
  StoreWindow(patch, samples, kWarpSize);
  return {samples, kWarpSize, patch.center, patch.mean, patch.variance};
}

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
  // Who is passed over needs no window.
  if (pixel.inside && !PassesOver(sweep, state, pixel.col, pixel.row)) {
    const Window window = WindowAt(
        problem, &windows[threadIdx.x / kWarpSize], pixel.col, pixel.row);
    const LaneCost<Sampler> cost(problem, window, pixel.col, pixel.row);
    VisitPixel<kKind>({problem.params,
                       problem.pattern,
                       sweep,
                       state,
                       problem.src_centers,
                       consistent},
                      cost,
                      pixel.col,
                      pixel.row);
    evaluations = cost.num_evaluations();
  }
  __syncwarp();
  CountEvaluations(evaluations, lane, num_evaluations);
}

template <class Sampler>
__global__ void __launch_bounds__(kWarpsPerBlock* kWarpSize)
    ScoreKernel(const __grid_constant__ DeviceProblem problem,
                const PixelPlane* planes,
                size_t num_planes,
                float* costs) {
  __shared__ WarpWindows windows[kWarpsPerBlock];
  const size_t i = static_cast<size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= num_planes) return;
  const PixelPlane at = planes[i];
  const Window window =
      WindowAt(problem, &windows[threadIdx.x / kWarpSize], at.col, at.row);
  const LaneCost<Sampler> cost(problem, window, at.col, at.row);
  costs[i] = CostFromAllViews(problem.params, cost, at.plane);
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
    case SweepKind::kMedian:
      LaunchPlainSweep(launch, stream);
      break;
  }
}

template <class Sampler>
void LaunchScoreWith(const ScoreLaunch& launch, cudaStream_t stream) {
  constexpr int kBlock = kWarpsPerBlock * kWarpSize;
  const unsigned blocks =
      static_cast<unsigned>((launch.num_planes + kBlock - 1) / kBlock);
  ScoreKernel<Sampler><<<blocks, kBlock, 0, stream>>>(
      *launch.problem, launch.planes, launch.num_planes, launch.costs);
  CheckCuda(cudaGetLastError(), "starting a kernel");
}

}  // namespace hpm
