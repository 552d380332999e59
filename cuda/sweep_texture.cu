#include "cuda/sweep_kernels.cuh"

namespace hpm {

void LaunchTextureSweep(const SweepLaunch& launch, cudaStream_t stream) {
  LaunchSweepWith<TextureSampler>(launch, stream);
}

void LaunchTextureScore(const ScoreLaunch& launch, cudaStream_t stream) {
  LaunchScoreWith<TextureSampler>(launch, stream);
}

}  // namespace hpm
