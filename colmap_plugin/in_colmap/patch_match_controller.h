// Dense stereo for COLMAP's callers, with the base class and the constructor of
// COLMAP's mvs::PatchMatchController. COLMAP's mvs/patch_match.h includes this
// file at its end, so it keeps to C++14 and names nothing of our library.
#pragma once

#include "colmap_plugin/in_colmap/colmap_api.h"

#include <string>

namespace colmap {
namespace mvs {

// HPM-MVS, or COLMAP's own method where COLMAP has it and
// PatchMatchOptions::hpm_mvs is false.
class HpmPatchMatchController : public hpm::in_colmap::ControllerBase {
 public:
  HpmPatchMatchController(const PatchMatchOptions& options,
                          const hpm::in_colmap::Path& workspace_path,
                          const std::string& workspace_format,
                          const std::string& pmvs_option_name,
                          const hpm::in_colmap::Path& config_path = "");

  // Returns early when COLMAP's stop is asked for. Throws std::runtime_error
  // after all views are done if one of them failed, and at once if the
  // workspace cannot be used; from a thread of COLMAP's this ends the program
  // with a non-zero exit code, as failures of COLMAP's own stereo do.
  void Run() override;

 private:
  void RunColmapsOwn();
  void RunHpmMvs();
  bool IsStopAskedFor();

  const PatchMatchOptions options_;
  const hpm::in_colmap::Path workspace_path_;
  const std::string workspace_format_;
  const std::string pmvs_option_name_;
  const hpm::in_colmap::Path config_path_;
};

// What the patches put in place of PatchMatchController.
using StereoController = HpmPatchMatchController;

}  // namespace mvs

// The command `colmap hpm_patch_match_stereo`: `hpm_mvs patch_match_stereo`
// with all its options and exit codes. argv[0] is the program.
int RunHpmPatchMatchStereo(int argc, char** argv);

}  // namespace colmap
