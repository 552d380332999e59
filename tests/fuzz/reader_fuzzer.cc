// A libFuzzer program per reader of files that come from elsewhere; which one
// is named by HPM_FUZZ_READER. Built and run by scripts/fuzz.sh, with
// sanitizers.
#include "tests/fuzz/readers.h"

#include <cstddef>
#include <cstdint>

#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string folder =
      "/dev/shm/hpm_fuzz_" HPM_FUZZ_READER "_" + std::to_string(getpid());
  hpm::ReadInput(
      HPM_FUZZ_READER, {reinterpret_cast<const char*>(data), size}, folder);
  return 0;
}
