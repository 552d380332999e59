#include "colmap_plugin/tool/run_stereo.h"

#include "colmap_plugin/controller/run_share.h"
#include "colmap_plugin/inspect/write_report.h"
#include "colmap_plugin/tool/help.h"
#include "src/base/retries.h"

#include <exception>
#include <filesystem>

#include <fmt/format.h>

namespace hpm {

RunSummary RunStereo(const ControllerOptions& options,
                     const LogSink& log,
                     const ProgressSink& progress,
                     const CancelToken& cancel) {
  RunSummary summary =
      PatchMatchController(options, log, progress, cancel).Run();
  if (!options.hpm.report) return summary;
  const RunShare share(options.hpm);
  // Other processes are still at work.
  if (!share.IsWhole() && !share.Finishes()) return summary;
  try {
    // Where nothing happened the page of the run before is still right.
    if (!share.Finishes() && summary.num_computed == 0 &&
        summary.failed.empty() && Exists(ReportPath(options))) {
      return summary;
    }
    // What is wrong with the workspace was said by the run.
    const std::filesystem::path path =
        WriteReport(options, {}, VersionLine(), nullptr, cancel);
    log(LogLevel::kInfo, "Report: " + path.string());
  } catch (const std::exception& error) {
    // The maps are there all the same, and so is the summary.
    if (!cancel.cancelled())
      log(LogLevel::kWarning, fmt::format("no report: {}", error.what()));
  }
  return summary;
}

}  // namespace hpm
