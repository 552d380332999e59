// How the kernels are shaped; the benchmark compares other numbers, given on
// the compiler's command line (bench/gpu_carry.sh). Measured: docs/gpu.md.
#pragma once

// At most 128 registers per thread.
#if !defined(HPM_BLOCKS_PER_PROCESSOR)
#define HPM_BLOCKS_PER_PROCESSOR 8
#endif
#if !defined(HPM_WARPS_PER_BLOCK)
#define HPM_WARPS_PER_BLOCK 2
#endif

namespace hpm {

constexpr int kBlocksPerProcessor = HPM_BLOCKS_PER_PROCESSOR;
constexpr int kWarpsPerBlock = HPM_WARPS_PER_BLOCK;

}  // namespace hpm
