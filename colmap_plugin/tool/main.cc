// The program `hpm_mvs`.

#include "colmap_plugin/tool/run_process.h"

#include <string>
#include <vector>

int main(int argc, char** argv) {
  // argv + 1 is past the end when argc is 0.
  return hpm::RunProcess(
      std::vector<std::string>(argv + (argc > 0), argv + argc));
}
