#include "cuda/sweep_kernels.cuh"

namespace hpm {

void LaunchQuadSweep(const SweepLaunch& launch, cudaStream_t stream) {
  LaunchSweepWith<QuadSampler>(launch, stream);
}

void LaunchQuadCosts(const SweepLaunch& launch,
                     float* costs,
                     cudaStream_t stream) {
  LaunchCostsWith<QuadSampler>(launch, costs, stream);
}

}  // namespace hpm
