// The program `hpm_mvs`.

#include "colmap_plugin/tool/run_process.h"

#include <string>
#include <vector>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

int main(int argc, char** argv) {
#if defined(__GLIBC__)
  // Maps and images go back to the system when they are freed. Left alone, the
  // C library learns to keep blocks of up to 32 MB, which then lie scattered.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
  // argv + 1 is past the end when argc is 0.
  return hpm::RunProcess(
      std::vector<std::string>(argv + (argc > 0), argv + argc));
}
