#include "python/src/patch_match_stereo.h"

#include "colmap_plugin/tool/help.h"
#include "colmap_plugin/tool/name_options.h"
#include "colmap_plugin/tool/run_stereo.h"
#include "colmap_plugin/tool/run_summary.h"
#include "python/src/background_run.h"
#include "python/src/errors.h"
#include "python/src/options.h"
#include "python/src/progress.h"
#include "src/base/error.h"

#include <atomic>
#include <utility>

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace hpm {
namespace {

// The levels of Python's logging.
int PythonLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kInfo:
      return 20;
    case LogLevel::kWarning:
      return 30;
    case LogLevel::kError:
      break;
  }
  return 40;
}

LogSink LogTo(nb::handle logger, const Post& post) {
  return [logger, post](LogLevel level, const std::string& message) {
    post([logger, level, line = NameOptions(message)] {
      // Another encoding than UTF-8 in a file name must not end the run.
      const nb::object text = nb::steal(PyUnicode_DecodeUTF8(
          line.data(), static_cast<Py_ssize_t>(line.size()), "replace"));
      logger.attr("log")(PythonLevel(level), text);
    });
  };
}

// Retries and the limit of threads belong to the process, not to a run.
class OnlyRun {
 public:
  OnlyRun() {
    if (is_there_.exchange(true)) {
      throw Error(ErrorCode::kUsage,
                  "another patch_match_stereo() is at work in this process; "
                  "wait for its end, or call it in a process of its own");
    }
  }
  ~OnlyRun() { is_there_ = false; }
  OnlyRun(const OnlyRun&) = delete;
  OnlyRun& operator=(const OnlyRun&) = delete;

 private:
  inline static std::atomic<bool> is_there_{false};
};

// An option of a function's own; nothing if it is empty.
void AddArgument(const std::string& name,
                 const std::string& value,
                 std::vector<std::string>* arguments) {
  if (!value.empty()) arguments->push_back("--" + name + "=" + value);
}

RunSummary PatchMatchStereo(nb::handle workspace_path,
                            const std::string& workspace_format,
                            const std::string& pmvs_option_name,
                            nb::handle given,
                            nb::handle config_path,
                            nb::handle progress,
                            const nb::kwargs& more) {
  std::vector<std::string> arguments, notes;
  AddArgument("workspace_path", PathText(workspace_path), &arguments);
  AddArgument("workspace_format", workspace_format, &arguments);
  AddArgument("pmvs_option_name", pmvs_option_name, &arguments);
  AddArgument("config_path", PathText(config_path), &arguments);
  const ControllerOptions options =
      ParsedFrom(OptionsFrom(given, more), std::move(arguments), &notes);
  CheckCallback(progress);
  const nb::object logger =
      nb::module_::import_("logging").attr("getLogger")("hpm_mvs");

  const OnlyRun only;
  RunSummary summary;
  RunInBackground([&](const CancelToken& cancel, const Post& post) {
    const LogSink log = LogTo(logger, post);
    log(LogLevel::kInfo, VersionLine());
    for (const std::string& note : notes) log(LogLevel::kWarning, note);
    summary = RunStereo(options, log, ProgressTo(progress, post), cancel);
    for (const std::string& line : SummaryLines(options, summary))
      log(LogLevel::kInfo, line);
  });
  if (!summary.failed.empty()) {
    RaiseWith(ErrorCode::kPartial,
              fmt::format("{} of {} images failed, the first: {}; the maps of "
                          "the others are valid",
                          summary.failed.size(),
                          summary.num_problems,
                          summary.failed.front()),
              "summary",
              nb::cast(summary));
  }
  return summary;
}

void BindSummary(nb::module_& module) {
  nb::class_<RunSummary>(module, "RunSummary", "What a run did.")
      .def_ro("num_problems", &RunSummary::num_problems, "Reference images")
      .def_ro("num_computed",
              &RunSummary::num_computed,
              "Images of which this run computed at least one stage")
      .def_ro("num_kept",
              &RunSummary::num_kept,
              "Images whose maps were all complete and current")
      .def_ro("failed",
              &RunSummary::failed,
              "Names of images that could not be computed")
      .def_ro("warnings", &RunSummary::warnings, "Those of the log")
      .def_ro("seconds", &RunSummary::seconds, "In all")
      .def_ro("planning_seconds",
              &RunSummary::planning_seconds,
              "Of these, before the first image")
      .def_ro("valid_pixel_share",
              &RunSummary::valid_pixel_share,
              "Of the final maps that this run wrote, 0 to 1; None: it wrote "
              "none")
      .def_prop_ro(
          "filter_losses",
          [](const RunSummary& summary) {
            nb::dict losses;
            for (const auto& [criterion, share] : summary.filter_losses)
              losses[NameOf(criterion)] = share;
            return losses;
          },
          nb::sig("def filter_losses(self, /) -> dict[str, float]"),
          "Share of the pixels that each criterion of the filter took, by its "
          "name")
      .def_ro("num_fusable",
              &RunSummary::num_fusable,
              "Images with final maps: what fusion will find")
      .def_ro("cost_evaluations_per_pixel",
              &RunSummary::cost_evaluations_per_pixel)
      .def_ro("peak_memory_bytes", &RunSummary::peak_memory_bytes)
      .def_ro("backend", &RunSummary::backend, "Where it was computed");
}

constexpr const char* kSignature =
    "def patch_match_stereo(workspace_path: str | os.PathLike[str], "
    "workspace_format: str = 'COLMAP', pmvs_option_name: str = 'option-all', "
    "options: object = None, config_path: str | os.PathLike[str] = '', *, "
    "progress: collections.abc.Callable[[ProgressEvent], object] | None = "
    "None, **more: object) -> RunSummary";

constexpr const char* kHelp =
    R"(Computes depth and normal maps of a COLMAP dense workspace, in the place of
pycolmap.patch_match_stereo: the same files in, the same files out, and those of
`hpm_mvs patch_match_stereo`, byte for byte.

workspace_path    folder with images/, sparse/ and stereo/
workspace_format  "COLMAP" or "PMVS"
pmvs_option_name  option file of a PMVS workspace
options           PatchMatchOptions, pycolmap.PatchMatchOptions, or a dict by name:
                  "max_image_size", "PatchMatchStereo.max_image_size", "Hpm.method"
config_path       file in place of the workspace's patch-match.cfg
progress          called with a ProgressEvent, in the thread of the caller; what it
                  raises stops the run and is raised here
more              options by name; they go before `options`

Messages go to the logger "hpm_mvs" of Python's logging. The GIL is released. Raises
a class of Error for each exit code of the program, and KeyboardInterrupt on Ctrl-C;
the same call again goes on where the run stopped. One run at a time: a second one in
another thread raises UsageError.)";

}  // namespace

void BindPatchMatchStereo(nb::module_& module) {
  BindSummary(module);
  module.def("patch_match_stereo",
             PatchMatchStereo,
             nb::arg("workspace_path"),
             nb::arg("workspace_format") = "COLMAP",
             nb::arg("pmvs_option_name") = "option-all",
             nb::arg("options").none() = nb::none(),
             nb::arg("config_path") = "",
             nb::kw_only(),
             nb::arg("progress").none() = nb::none(),
             nb::arg("more"),
             nb::sig(kSignature),
             kHelp);
}

}  // namespace hpm
