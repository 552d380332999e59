// A program named `colmap` for pipelines that call COLMAP by name: it hands
// `patch_match_stereo` to hpm_mvs and every other command to the real colmap
// behind it on PATH. It replaces itself by that program, so arguments,
// environment, exit codes and signals are those of a direct call.

#include "colmap_plugin/wrapper/find_program.h"
#include "src/base/platform/processes.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace {

namespace fs = std::filesystem;

// As a shell says it of a command that is not there.
constexpr int kNotFound = 127;

std::string_view SearchPath() {
  const char* path = std::getenv("PATH");
  return path == nullptr ? "/usr/local/bin:/usr/bin:/bin" : path;
}

// Beside this program as installed, else on PATH (as in a build folder).
fs::path FindHpmMvs(const fs::path& self) {
  fs::path installed =
      (self.parent_path() / HPM_MVS_FROM_WRAPPER).lexically_normal();
  if (hpm::IsExecutable(installed)) return installed;
  return hpm::FindLater(SearchPath(), "hpm_mvs", "");
}

}  // namespace

int main(int argc, char** argv) {
  const fs::path self = hpm::ThisProgram();
  if (self.empty()) {
    std::fprintf(stderr,
                 "ERROR: the system does not say where this program lies; "
                 "mount /proc\n");
    return kNotFound;
  }
  const bool is_stereo =
      argc > 1 && std::strcmp(argv[1], "patch_match_stereo") == 0;
  const fs::path program = is_stereo
                               ? FindHpmMvs(self)
                               : hpm::FindLater(SearchPath(), "colmap", self);
  if (program.empty()) {
    std::fprintf(
        stderr,
        is_stereo ? "ERROR: hpm_mvs is neither in its place beside %s nor on "
                    "PATH; install hpm_mvs again\n"
                  : "ERROR: no colmap behind %s on PATH; install COLMAP or "
                    "add its folder to the end of PATH\n",
        self.parent_path().string().c_str());
    return kNotFound;
  }
  const int exit_code = hpm::ReplaceThisProgram(program, argv);
  if (exit_code >= 0) return exit_code;
  std::fprintf(stderr,
               "ERROR: %s cannot be started: %s\n",
               program.string().c_str(),
               std::strerror(errno));
  return kNotFound - 1;
}
