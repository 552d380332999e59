#include "cuda/sweep_kernels.cuh"

namespace hpm {

void LaunchQuadSweep(const SweepLaunch& launch, cudaStream_t stream) {
  LaunchSweepWith<QuadSampler>(launch, stream);
}

void LaunchQuadScore(const ScoreLaunch& launch, cudaStream_t stream) {
  LaunchScoreWith<QuadSampler>(launch, stream);
}

}  // namespace hpm
