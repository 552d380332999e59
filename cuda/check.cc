#include "cuda/check.h"

#include "src/base/remedies.h"
#include "src/engine/gpu_error.h"

#include <string>

namespace hpm {

void CheckCuda(cudaError_t status, const char* doing) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // forget it where it does not stick
  if (status == cudaErrorMemoryAllocation) {
    throw GpuError(ErrorCode::kOutOfResources,
                   std::string("GPU: out of memory while ") + doing + "; use " +
                       kSmallerImages + ", " + kFewerImagesAtOnce + ", or " +
                       kComputeOnCpu);
  }
  throw GpuError(ErrorCode::kDevice,
                 std::string("GPU: ") + cudaGetErrorString(status) + " (" +
                     cudaGetErrorName(status) + ") while " + doing + "; " +
                     kComputeOnCpu);
}

}  // namespace hpm
