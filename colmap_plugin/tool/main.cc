// The program `hpm_mvs`.

#include "colmap_plugin/tool/run_process.h"

#include <string>
#include <vector>

#if defined(__GLIBC__)
#include <malloc.h>
#include <sys/resource.h>
#endif

int main(int argc, char** argv) {
#if defined(__GLIBC__)
  // Maps and images go back to the system when they are freed. Left alone, the
  // C library learns to keep blocks of up to 32 MB, which then lie scattered.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  // Each thread would reserve 64 MB for a heap of its own.
  rlimit address_space = {};
  if (getrlimit(RLIMIT_AS, &address_space) == 0 &&
      address_space.rlim_cur != RLIM_INFINITY) {
    mallopt(M_ARENA_MAX, 1);
  }
#endif
  // argv + 1 is past the end when argc is 0.
  return hpm::RunProcess(
      std::vector<std::string>(argv + (argc > 0), argv + argc));
}
