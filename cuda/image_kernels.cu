// Kernels that need no matching cost: followers, the median, the making of
// images.
#include "cuda/check.h"
#include "cuda/launch.h"
#include "cuda/warp.h"
#include "src/gpu/texel_image.h"
#include "src/gpu/upsampled_prior.h"

namespace hpm {
namespace {

constexpr int kBlock = 128;

// The pixel of this thread; not inside the image: nothing to do.
__device__ Pixel PixelOfThread(const Band& band) {
  const int64_t thread =
      static_cast<int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (thread >= band.num_warps() * kWarpSize) return {0, 0, false};
  return PixelOf(
      band, thread / kWarpSize, static_cast<int>(thread % kWarpSize));
}

__global__ void PlainSweepKernel(const VisitParams params,
                                 const Sweep sweep,
                                 const PixelState state,
                                 const Band band) {
  const Pixel pixel = PixelOfThread(band);
  if (pixel.inside) VisitPixel(params, sweep, state, pixel.col, pixel.row);
}

__global__ void Upsample(const __grid_constant__ DeviceProblem problem,
                         const Plane* low,
                         int level,
                         Plane* planes) {
  const int width = problem.params.ref.width;
  const size_t at = static_cast<size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (at >= static_cast<size_t>(width) * problem.params.ref.height) return;
  planes[at] = UpsampledPriorAt(problem,
                                low,
                                level,
                                static_cast<int>(at % width),
                                static_cast<int>(at / width));
}

__global__ void PackTexels(const uint8_t* grey,
                           int width,
                           int height,
                           uint32_t* texels) {
  const size_t at = static_cast<size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (at >= static_cast<size_t>(width) * height) return;
  texels[at] = TexelAt(grey,
                       width,
                       height,
                       static_cast<int>(at % width),
                       static_cast<int>(at / width));
}

__global__ void FillLayer(const uint8_t* grey,
                          int width,
                          int height,
                          int layer_width,
                          int layer_height,
                          uint8_t* layer) {
  const size_t at = static_cast<size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (at >= static_cast<size_t>(layer_width) * layer_height) return;
  const int col = min(static_cast<int>(at % layer_width), width - 1);
  const int row = min(static_cast<int>(at / layer_width), height - 1);
  layer[at] = grey[static_cast<size_t>(row) * width + col];
}

unsigned Blocks(size_t threads) {
  return static_cast<unsigned>((threads + kBlock - 1) / kBlock);
}

}  // namespace

void LaunchPlainSweep(const SweepLaunch& launch, cudaStream_t stream) {
  PlainSweepKernel<<<Blocks(launch.band.num_warps() * kWarpSize),
                     kBlock,
                     0,
                     stream>>>(
      launch.problem->params, launch.sweep, launch.state, launch.band);
  CheckCuda(cudaGetLastError(), "starting a kernel");
}

void LaunchUpsample(const DeviceProblem& problem,
                    const Plane* low,
                    int level,
                    Plane* planes,
                    cudaStream_t stream) {
  const Camera& ref = problem.params.ref;
  Upsample<<<Blocks(static_cast<size_t>(ref.width) * ref.height),
             kBlock,
             0,
             stream>>>(problem, low, level, planes);
  CheckCuda(cudaGetLastError(), "upsampling a prior");
}

void LaunchPackTexels(const uint8_t* grey,
                      int width,
                      int height,
                      uint32_t* texels,
                      cudaStream_t stream) {
  const size_t size = static_cast<size_t>(width) * height;
  PackTexels<<<Blocks(size), kBlock, 0, stream>>>(grey, width, height, texels);
  CheckCuda(cudaGetLastError(), "packing an image");
}

void LaunchFillLayer(const uint8_t* grey,
                     int width,
                     int height,
                     int layer_width,
                     int layer_height,
                     uint8_t* layer,
                     cudaStream_t stream) {
  const size_t size = static_cast<size_t>(layer_width) * layer_height;
  FillLayer<<<Blocks(size), kBlock, 0, stream>>>(
      grey, width, height, layer_width, layer_height, layer);
  CheckCuda(cudaGetLastError(), "making a texture");
}

}  // namespace hpm
