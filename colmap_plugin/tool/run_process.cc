#include "colmap_plugin/tool/run_process.h"

#include "colmap_plugin/controller/run_share.h"
#include "colmap_plugin/inspect/check_maps.h"
#include "colmap_plugin/inspect/export_maps.h"
#include "colmap_plugin/inspect/plan_run.h"
#include "colmap_plugin/inspect/run_status.h"
#include "colmap_plugin/inspect/write_report.h"
#include "colmap_plugin/tool/dispatch.h"
#include "colmap_plugin/tool/help.h"
#include "colmap_plugin/tool/run_stereo.h"
#include "colmap_plugin/tool/signals.h"
#include "src/base/error.h"
#include "src/base/platform/terminal.h"

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>

namespace hpm {
namespace {

bool IsTerminal() {
  const char* name = std::getenv("TERM");
  return IsStandardOutputATerminal() && name != nullptr &&
         std::string_view(name) != "dumb";
}

int Columns() {
  const int columns = TerminalColumns();
  return columns > 0 ? columns : 80;
}

double Seconds() {
  using std::chrono::steady_clock;
  return std::chrono::duration<double>(steady_clock::now().time_since_epoch())
      .count();
}

int RunReport(const CommandCall& call) {
  const std::filesystem::path path = WriteReport(call.options,
                                                 call.own.report_path,
                                                 VersionLine(),
                                                 call.log,
                                                 *call.cancel);
  call.log(LogLevel::kInfo, "Report: " + path.string());
  return 0;
}

int RunPlanCommand(const CommandCall& call) {
  const RunPlan plan =
      PlanRun(call.options, call.own.sample_seconds, call.log, *call.cancel);
  std::string text;
  for (const std::string& line : plan.lines) text += line + "\n";
  const int printed = call.print(text);
  for (const std::string& problem : plan.problems)
    call.log(LogLevel::kError, problem);
  if (plan.problems.empty())
    call.log(LogLevel::kInfo, "Nothing stops this run");
  return plan.exit_code != 0 ? plan.exit_code : printed;
}

int RunCheck(const CommandCall& call) {
  const MapCheck check =
      CheckMaps(call.options, call.own.fix, call.log, *call.cancel);
  const int printed = call.print(CheckText(check));
  return printed != 0 ? printed : check.ExitCode();
}

int RunExport(const CommandCall& call) {
  const ExportResult result = ExportMaps(
      call.options.workspace, call.own.export_maps, call.log, *call.cancel);
  if (!result.failed.empty()) {
    call.log(LogLevel::kError,
             fmt::format("{} images could not be exported, the first: {}",
                         result.failed.size(),
                         result.failed.front()));
  }
  call.log(LogLevel::kInfo,
           fmt::format("{} images exported to {}",
                       result.num_images,
                       result.folder.string()));
  return result.failed.empty() ? 0 : static_cast<int>(ErrorCode::kPartial);
}

int RunStatusCommand(const CommandCall& call) {
  // Whoever reads standard output reads the answer.
  const LogSink warnings = [&call](LogLevel level, const std::string& line) {
    if (level != LogLevel::kInfo) call.log(level, line);
  };
  const RunStatus status =
      FindStatus(call.options, call.own.verify, warnings, *call.cancel);
  const int printed = call.print(
      call.own.format == "json" ? StatusJson(status) : StatusText(status));
  if (printed != 0) return printed;
  if (status.num_needed() > 0) return static_cast<int>(kNotReady);
  return status.failing.empty() ? 0 : static_cast<int>(ErrorCode::kPartial);
}

}  // namespace

int RunProcess(const std::vector<std::string>& arguments) {
  OpenStandardStreams();
  // What OpenCV would print about a file is said by our own messages.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  const CancelToken& cancel = InstallSignalHandlers();
  ToolEnvironment tool{&std::cout,
                       &std::cerr,
                       IsTerminal(),
                       Columns(),
                       Seconds,
                       &cancel,
                       RunStereo,
                       {{"plan", RunPlanCommand},
                        {"check", RunCheck},
                        {"status", RunStatusCommand},
                        {"export", RunExport},
                        {"report", RunReport}}};
  const int exit_code = RunTool(arguments, tool);
  const bool interrupted =
      exit_code == static_cast<int>(ErrorCode::kInterrupted);
  return interrupted && CaughtSignal() != 0 ? 128 + CaughtSignal() : exit_code;
}

}  // namespace hpm
