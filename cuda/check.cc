#include "cuda/check.h"

#include "src/engine/gpu_error.h"

#include <string>

namespace hpm {

void CheckCuda(cudaError_t status, const char* doing) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // forget it where it does not stick
  if (status == cudaErrorMemoryAllocation) {
    throw GpuError(ErrorCode::kOutOfResources,
                   std::string("GPU: out of memory while ") + doing +
                       "; set a smaller --PatchMatchStereo.max_image_size, "
                       "--Hpm.gpu_images 1 or --Hpm.device cpu");
  }
  throw GpuError(ErrorCode::kDevice,
                 std::string("GPU: ") + cudaGetErrorString(status) + " (" +
                     cudaGetErrorName(status) + ") while " + doing +
                     "; set --Hpm.device cpu to compute on the CPU");
}

}  // namespace hpm
