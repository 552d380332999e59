#include "cuda/cuda_devices.h"

#include <cuda_runtime_api.h>

namespace hpm {

std::vector<CudaDevice> FindCudaDevices(std::string* why_none) {
  std::vector<CudaDevice> devices;
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess) {
    cudaGetLastError();
    *why_none = cudaGetErrorString(status);
    return devices;
  }
  for (int index = 0; index < count; ++index) {
    cudaDeviceProp properties;
    int clock_khz = 0;
    size_t free_bytes = 0, total_bytes = 0;
    if (cudaSetDevice(index) != cudaSuccess ||
        cudaGetDeviceProperties(&properties, index) != cudaSuccess ||
        cudaMemGetInfo(&free_bytes, &total_bytes) != cudaSuccess) {
      cudaGetLastError();
      *why_none = "device " + std::to_string(index) + " does not answer";
      continue;
    }
    cudaDeviceGetAttribute(&clock_khz, cudaDevAttrClockRate, index);
    cudaGetLastError();
    devices.push_back({index,
                       properties.name,
                       properties.major,
                       properties.minor,
                       properties.multiProcessorCount,
                       clock_khz * 1e-6,
                       total_bytes,
                       free_bytes});
  }
  if (devices.empty() && why_none->empty()) *why_none = "no CUDA device";
  return devices;
}

}  // namespace hpm
