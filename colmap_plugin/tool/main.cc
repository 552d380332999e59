// The program `hpm_mvs`: real streams, clock, signals and controller around
// RunTool.

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/tool/dispatch.h"
#include "colmap_plugin/tool/signals.h"
#include "src/base/error.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <sys/ioctl.h>
#include <unistd.h>

namespace {

bool IsTerminal() {
  const char* name = std::getenv("TERM");
  return isatty(STDOUT_FILENO) && name != nullptr &&
         std::string_view(name) != "dumb";
}

int TerminalColumns() {
  winsize size = {};
  const bool known =
      ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

double Seconds() {
  using std::chrono::steady_clock;
  return std::chrono::duration<double>(steady_clock::now().time_since_epoch())
      .count();
}

hpm::RunSummary RunStereo(const hpm::ControllerOptions& options,
                          const hpm::LogSink& log,
                          const hpm::ProgressSink& progress,
                          const hpm::CancelToken& cancel) {
  return hpm::PatchMatchController(options, log, progress, cancel).Run();
}

}  // namespace

int main(int argc, char** argv) {
  const hpm::CancelToken& cancel = hpm::InstallSignalHandlers();
  hpm::ToolEnvironment tool{&std::cout,
                            &std::cerr,
                            IsTerminal(),
                            TerminalColumns(),
                            Seconds,
                            &cancel,
                            RunStereo};
  // argv + 1 is past the end when argc is 0.
  const int exit_code = hpm::RunTool(
      std::vector<std::string>(argv + (argc > 0), argv + argc), tool);
  const bool interrupted =
      exit_code == static_cast<int>(hpm::ErrorCode::kInterrupted);
  return interrupted && hpm::CaughtSignal() == SIGTERM ? 128 + SIGTERM
                                                       : exit_code;
}
