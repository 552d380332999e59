#include "colmap_plugin/tool/run_command.h"

#include "colmap_plugin/options/option_record.h"
#include "colmap_plugin/tool/help.h"
#include "colmap_plugin/tool/name_options.h"
#include "colmap_plugin/tool/parse_command.h"
#include "colmap_plugin/tool/parse_options.h"
#include "colmap_plugin/tool/run_summary.h"
#include "src/base/error.h"
#include "src/base/retries.h"

#include <cerrno>
#include <exception>
#include <new>
#include <ostream>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hpm {
namespace {

int ExitCode(ErrorCode code) { return static_cast<int>(code); }

// "a, b, c", or the first ones and how many more.
std::string ListOf(const std::vector<std::string>& names) {
  constexpr size_t kMaxNames = 10;
  if (names.size() <= kMaxNames)
    return fmt::format("{}", fmt::join(names, ", "));
  return fmt::format("{} and {} more",
                     fmt::join(names.begin(), names.begin() + kMaxNames, ", "),
                     names.size() - kMaxNames);
}

LogSink LogTo(ProgressLine* progress) {
  return [progress](LogLevel level, const std::string& message) {
    progress->Log(level, NameOptions(message));
  };
}

int RunAndReport(const ControllerOptions& options,
                 const ToolEnvironment& tool,
                 ProgressLine* progress) {
  const LogSink log = LogTo(progress);
  const RunSummary summary = tool.run_stereo(
      options,
      log,
      [progress](const ProgressEvent& event) { progress->Update(event); },
      *tool.cancel);
  progress->Close();
  for (const std::string& line : SummaryLines(options, summary))
    log(LogLevel::kInfo, line);
  // COLMAP's last line, which wrappers look for.
  log(LogLevel::kInfo,
      fmt::format("Elapsed time: {:.3f} [minutes]", summary.seconds / 60));
  if (!summary.failed.empty()) {
    log(LogLevel::kError,
        fmt::format(
            "{} of {} images failed: {}; the maps of the others are valid",
            summary.failed.size(),
            summary.num_problems,
            ListOf(summary.failed)));
  }
  const int exit_code =
      summary.failed.empty() ? 0 : ExitCode(ErrorCode::kPartial);
  progress->Result(
      {{"exit_code", exit_code},
       {"images", summary.num_problems},
       {"computed", summary.num_computed},
       {"kept", summary.num_kept},
       {"failed", summary.failed},
       {"valid_pixel_share",
        summary.valid_pixel_share ? nlohmann::json(*summary.valid_pixel_share)
                                  : nlohmann::json()},
       {"seconds", summary.seconds},
       {"peak_memory_bytes", summary.peak_memory_bytes}});
  return exit_code;
}

// Says what is wrong with the options, or does the work and says what went
// wrong there.
int Guarded(const ToolEnvironment& tool,
            const ParsedOptions& parsed,
            const std::function<int(ProgressLine*)>& work) {
  ProgressLine progress(tool.out,
                        tool.err,
                        tool.terminal,
                        tool.columns,
                        tool.clock,
                        parsed.options.controller.hpm.log_format == "json");
  const RetryScope retries(LogTo(&progress), tool.cancel);
  const auto fail = [&progress](ErrorCode code, const std::string& message) {
    progress.Close();
    progress.Log(LogLevel::kError, message);
    return ExitCode(code);
  };
  try {
    for (const std::string& problem : parsed.problems)
      progress.Log(LogLevel::kError, problem);
    if (!parsed.problems.empty()) return ExitCode(ErrorCode::kUsage);
    return work(&progress);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kInterrupted) {
      return fail(error.code(),
                  "interrupted; give the same command again to go on");
    }
    return fail(error.code(), NameOptions(error.what()));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kOutOfResources,
                "out of memory; lower --PatchMatchStereo.cache_size (GiB) or "
                "--PatchMatchStereo.max_image_size (pixels)");
  } catch (const std::exception& error) {
    return fail(ErrorCode::kFailure, error.what());
  }
}

}  // namespace

int Print(const std::string& text, const ToolEnvironment& tool) {
  errno = 0;
  if (*tool.out << text << std::flush) return 0;
  if (errno == EPIPE) return 0;  // `| head -1` has seen enough
  *tool.err << "ERROR: standard output cannot be written; check where it goes\n"
            << std::flush;
  return ExitCode(ErrorCode::kFailure);
}

int RunPatchMatchStereo(const std::vector<std::string>& arguments,
                        const ToolEnvironment& tool) {
  const ParsedOptions parsed = ParseOptions(arguments);
  if (parsed.help) return Print(HelpText(), tool);
  return Guarded(tool, parsed, [&](ProgressLine* progress) {
    progress->Log(LogLevel::kInfo, VersionLine());
    for (const std::string& note : parsed.notes)
      progress->Log(LogLevel::kWarning, note);
    progress->Options(OptionRecord(parsed.options.controller));
    return RunAndReport(parsed.options.controller, tool, progress);
  });
}

int RunCommand(const Command& command,
               const std::vector<std::string>& arguments,
               const ToolEnvironment& tool) {
  ParsedCommand parsed = ParseCommand(command, arguments);
  // They answer in their own form.
  parsed.run.options.controller.hpm.log_format = HpmOptions().log_format;
  if (parsed.run.help) return Print(CommandHelp(command), tool);
  return Guarded(tool, parsed.run, [&](ProgressLine* progress) {
    for (const std::string& note : parsed.run.notes)
      progress->Log(LogLevel::kWarning, note);
    const CommandCall call = {
        parsed.run.options.controller,
        parsed.own,
        LogTo(progress),
        [&tool](const std::string& text) { return Print(text, tool); },
        tool.cancel};
    return tool.commands.at(command.name)(call);
  });
}

}  // namespace hpm
