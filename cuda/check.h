// Every call of the CUDA runtime goes through here.
#pragma once

#include <cuda_runtime_api.h>

namespace hpm {

// Throws GpuError(kOutOfResources) when the card's memory is exhausted, else
// GpuError(kDevice), naming what was being done.
void CheckCuda(cudaError_t status, const char* doing);

}  // namespace hpm
