#include "cuda/sweep_kernels.cuh"

namespace hpm {

void LaunchTextureSweep(const SweepLaunch& launch, cudaStream_t stream) {
  LaunchSweepWith<TextureSampler>(launch, stream);
}

void LaunchTextureCosts(const SweepLaunch& launch,
                        float* costs,
                        cudaStream_t stream) {
  LaunchCostsWith<TextureSampler>(launch, costs, stream);
}

}  // namespace hpm
