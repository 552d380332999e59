#include "colmap_plugin/in_colmap/patch_match_controller.h"
#include "colmap_plugin/tool/run_process.h"

#include <string>
#include <vector>

namespace colmap {

int RunHpmPatchMatchStereo(int argc, char** argv) {
  std::vector<std::string> arguments = {"patch_match_stereo"};
  if (argc > 1) arguments.insert(arguments.end(), argv + 1, argv + argc);
  return hpm::RunProcess(arguments);
}

}  // namespace colmap
