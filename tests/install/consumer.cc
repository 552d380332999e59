// Links the installed library: makes the CPU backend, and a controller that
// must refuse a workspace that is not there.

#include "colmap_plugin/controller/controller.h"
#include "src/base/error.h"
#include "src/cpu/cpu_backend.h"

#include <cstdio>
#include <string>

int main() {
  const auto backend = hpm::MakeCpuBackend("auto", 1);
  std::printf("%s\n", backend->Name().c_str());

  hpm::ControllerOptions options;
  options.workspace.path = "/no/such/workspace";
  const hpm::CancelToken cancel;
  try {
    hpm::PatchMatchController(
        options,
        [](hpm::LogLevel, const std::string&) {},
        [](const hpm::ProgressEvent&) {},
        cancel)
        .Run();
  } catch (const hpm::Error& error) {
    std::printf("%s\n", error.what());
    return error.code() == hpm::ErrorCode::kBadInput ? 0 : 1;
  }
  return 1;
}
