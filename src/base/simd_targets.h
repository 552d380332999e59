// Which of Highway's targets the SIMD code is compiled for, and how their
// functions are found. Include before hwy/foreach_target.h.
#pragma once

// Vectors of a length unknown to the compiler cannot be array elements, as the
// matching cost's are; ARM's servers take NEON.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)

// Highway's fallback is one lane, with every compiler, and unused: the readable
// scalar code stands in. Its other one, emulated vectors, is for some compilers
// only, and its vectors are no registers of the processor.
#define HWY_BROKEN_EMU128 1

#include <cstddef>
#include <cstdint>

#include <hwy/targets.h>

namespace hpm {

// Where a dispatch table of this size has the functions of a target that this
// machine can run.
inline size_t TargetIndex(int64_t target, size_t table_size) {
  if (table_size == 1) return 0;
  hwy::ChosenTarget chosen;  // our own, not Highway's process-wide one
  chosen.Update(target);
  return chosen.GetIndex();
}

}  // namespace hpm
