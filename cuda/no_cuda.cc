// In place of the CUDA backend in a build without nvcc.
#include "cuda/cuda_backend.h"
#include "cuda/cuda_devices.h"
#include "src/engine/gpu_error.h"

namespace hpm {
namespace {

const char kReason[] =
    "this program was built without CUDA (HPM_CUDA, nvcc on the PATH)";

}  // namespace

std::vector<CudaDevice> FindCudaDevices(std::string* why_none) {
  *why_none = kReason;
  return {};
}

std::unique_ptr<CudaBackend> MakeCudaBackend(const CudaOptions&) {
  throw GpuError(ErrorCode::kDevice, kReason);
}

}  // namespace hpm
