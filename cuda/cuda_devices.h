// The cards of this machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hpm {

struct CudaDevice {
  int index;  // CUDA's
  std::string name;
  int major, minor;  // compute capability
  int num_processors;
  double clock_ghz;  // 0: not told
  uint64_t total_bytes, free_bytes;
};

// Empty, with the reason in *why_none, if there are none: no driver, no card,
// or a build without CUDA. Never throws.
std::vector<CudaDevice> FindCudaDevices(std::string* why_none);

}  // namespace hpm
