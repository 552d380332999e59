#include "colmap_plugin/in_colmap/patch_match_controller.h"

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/in_colmap/convert_options.h"
#include "src/base/error.h"

#include <chrono>
#include <future>
#include <iostream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

// COLMAP's own controller holds one, declared only.
#if __has_include("colmap/mvs/workspace.h")
#include "colmap/mvs/workspace.h"
#else
#include "mvs/workspace.h"
#endif

namespace colmap {
namespace mvs {
namespace {

// Where COLMAP's own stereo writes.
void Log(hpm::LogLevel level, const std::string& message) {
#if __has_include("colmap/mvs/patch_match.h")
  if (level == hpm::LogLevel::kError) {
    LOG(ERROR) << message;
  } else if (level == hpm::LogLevel::kWarning) {
    LOG(WARNING) << message;
  } else {
    LOG(INFO) << message;
  }
#else
  const char* const kPrefix[] = {"", "WARNING: ", "ERROR: "};
  std::cout << kPrefix[static_cast<int>(level)] << message << std::endl;
#endif
}

}  // namespace

HpmPatchMatchController::HpmPatchMatchController(
    const PatchMatchOptions& options,
    const hpm::in_colmap::Path& workspace_path,
    const std::string& workspace_format,
    const std::string& pmvs_option_name,
    const hpm::in_colmap::Path& config_path)
    : options_(options),
      workspace_path_(workspace_path),
      workspace_format_(workspace_format),
      pmvs_option_name_(pmvs_option_name),
      config_path_(config_path) {}

void HpmPatchMatchController::Run() {
#ifdef HPM_COLMAP_HAS_OWN_STEREO
  if (!options_.hpm_mvs) {
    RunColmapsOwn();
    return;
  }
#endif
  RunHpmMvs();
}

#ifdef HPM_COLMAP_HAS_OWN_STEREO
void HpmPatchMatchController::RunColmapsOwn() {
  PatchMatchController own(options_,
                           workspace_path_,
                           workspace_format_,
                           pmvs_option_name_,
                           config_path_);
#ifdef HPM_COLMAP_HAS_BASE_CONTROLLER
  own.SetCheckIfStoppedFunc([this] { return IsStopAskedFor(); });
  own.Run();
#else
  own.Start();
  while (!own.IsFinished()) {
    if (IsStopped()) own.Stop();
    IsPaused() ? own.Pause() : own.Resume();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  own.Wait();
#endif
}
#endif

void HpmPatchMatchController::RunHpmMvs() {
  hpm::CancelToken cancel;
  const auto progress = [&](const hpm::ProgressEvent&) {
#ifndef HPM_COLMAP_HAS_BASE_CONTROLLER
    BlockIfPaused();
#endif
  };
  hpm::RunSummary summary;
  try {
    hpm::PatchMatchController controller(
        hpm::in_colmap::ConvertOptions(options_,
                                       workspace_path_,
                                       workspace_format_,
                                       pmvs_option_name_,
                                       config_path_,
                                       kDefaultPRNGSeed),
        Log,
        progress,
        cancel);
    // Beside this thread, which asks whether to stop all the while: planning
    // tells no progress.
    std::future<hpm::RunSummary> run =
        std::async(std::launch::async, [&] { return controller.Run(); });
    do {
      if (IsStopAskedFor()) cancel.Cancel();
    } while (run.wait_for(std::chrono::milliseconds(50)) !=
             std::future_status::ready);
    summary = run.get();
  } catch (const hpm::Error& error) {
    if (error.code() == hpm::ErrorCode::kInterrupted) return;
    Log(hpm::LogLevel::kError, error.what());
    throw;
  }
  Log(hpm::LogLevel::kInfo,
      fmt::format("Elapsed time: {:.3f} [minutes]", summary.seconds / 60));
  if (summary.failed.empty()) return;
  const std::string message = fmt::format(
      "{} of {} images failed: {}; the maps of the others are valid",
      summary.failed.size(),
      summary.num_problems,
      fmt::join(summary.failed, ", "));
  Log(hpm::LogLevel::kError, message);
  throw hpm::Error(hpm::ErrorCode::kPartial, message);
}

bool HpmPatchMatchController::IsStopAskedFor() {
#ifdef HPM_COLMAP_HAS_BASE_CONTROLLER
  return CheckIfStopped();
#else
  return IsStopped();
#endif
}

}  // namespace mvs
}  // namespace colmap
