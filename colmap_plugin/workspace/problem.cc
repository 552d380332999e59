#include "colmap_plugin/workspace/problem.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/workspace/cfg_check.h"
#include "colmap_plugin/workspace/image_files.h"
#include "colmap_plugin/workspace/model_overview.h"
#include "colmap_plugin/workspace/planning_progress.h"
#include "src/base/error.h"
#include "src/base/retries.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// "reference image a.jpg" or "3 reference images (the first: a.jpg)".
std::string Describe(const ImageFault& images) {
  if (images.num() == 1) return "reference image " + images.first();
  return fmt::format(
      "{} reference images (the first: {})", images.num(), images.first());
}

class ProblemReader {
 public:
  ProblemReader(const Workspace& workspace,
                const ModelOverview& overview,
                const ProblemOptions& options,
                const LogSink& log,
                const CancelToken& cancel)
      : workspace_(workspace),
        options_(options),
        log_(log),
        cancel_(cancel),
        path_(options.config_path.empty() ? workspace.PatchMatchCfgPath()
                                          : options.config_path),
        automatic_(overview.automatic()),
        ranges_(overview.ranges()) {}

  std::vector<StereoProblem> Read() {
    std::vector<bool> seen(workspace_.num_images(), false);
    std::vector<Choice> choices;
    const PatchMatchCfg cfg = ReadCfg();
    CheckCfg(workspace_, path_, cfg, log_);
    CheckNames(cfg);
    for (const PatchMatchCfgEntry& entry : cfg.entries) {
      const int ref = workspace_.ImageIndex(entry.ref_name);
      if (seen[ref]) {
        Warn("Ignoring line {} of {}: {} was listed before.",
             entry.line,
             path_.string(),
             entry.ref_name);
        continue;
      }
      seen[ref] = true;
      if (!workspace_.usable(ref)) {
        Warn("Ignoring reference image {}, because its camera cannot be used.",
             entry.ref_name);
        continue;
      }
      choices.push_back({&entry, ref, std::nullopt, {}, {}});
    }
    ChooseSources(&choices);

    std::vector<StereoProblem> problems;
    for (Choice& choice : choices) {
      const PatchMatchCfgEntry& entry = *choice.entry;
      const int ref = choice.ref;
      const std::optional<DepthRange>& range = choice.range;
      std::vector<int> sources =
          entry.sources == PatchMatchCfgEntry::Sources::kList
              ? ListedSources(entry, ref)
              : std::move(choice.sources);
      if (sources.empty()) {
        without_sources_.Add(entry.ref_name);
        continue;
      }
      std::vector<int> wanted = sources;
      wanted.resize(
          std::min({wanted.size(), MostAutomatic(entry), MaxNumSources()}));
      TakeThoseWithPictures(workspace_, MostAutomatic(entry), &sources);
      if (!range) {
        without_range_.Add(entry.ref_name);
        continue;
      }
      if (ranges_.IsEstimated(ref)) estimated_.Add(entry.ref_name);
      if (!automatic_.SharesPoints(ref)) unshared_.Add(entry.ref_name);
      if (sources.size() > MaxNumSources()) {
        sources.resize(MaxNumSources());
        ++num_cut_;
      }
      StereoProblem problem;
      problem.ref_image = ref;
      problem.src_images = std::move(sources);
      problem.wanted_sources = std::move(wanted);
      problem.depth_min = range->min;
      problem.depth_max = range->max;
      problem.published = ranges_.Published(ref);
      problem.shares_points = automatic_.SharesPoints(ref);
      problems.push_back(std::move(problem));
    }
    if (num_cut_ > 0 && log_) {
      log_(LogLevel::kInfo,
           fmt::format("{} reference images have more than {} source images; "
                       "the first {} are used.",
                       num_cut_,
                       MaxNumSources(),
                       MaxNumSources()));
    }
    Report();
    if (problems.empty()) FailWithoutProblems(seen);
    return problems;
  }

 private:
  struct Choice {
    const PatchMatchCfgEntry* entry;
    int ref;
    std::optional<DepthRange> range;
    // Where the sources are not listed:
    std::vector<SourceCandidate> sharing;
    std::vector<int> sources;
  };

  // And their ranges, by which is found who sees the same place where tracks do
  // not tell.
  void ChooseSources(std::vector<Choice>* choices) const {
    CountShared(choices);
    PlanningProgress progress(
        "Choosing source images", choices->size(), log_, cancel_);
    tbb::parallel_for(size_t{0}, choices->size(), [&](size_t i) {
      Choice& choice = (*choices)[i];
      choice.range = ranges_.ForImage(choice.ref);
      if (IsAutomatic(choice)) choice.sources = AutomaticSourcesOf(choice);
      progress.Count();
    });
  }

  void CountShared(std::vector<Choice>* choices) const {
    std::vector<int> refs;
    for (const Choice& choice : *choices) {
      if (IsAutomatic(choice)) refs.push_back(choice.ref);
    }
    PlanningProgress progress(
        "Counting shared points", refs.size(), log_, cancel_);
    std::vector<std::vector<SourceCandidate>> sharing = automatic_.Sharing(
        refs, options_.min_triangulation_angle, [&] { progress.Count(); });
    auto of_next = sharing.begin();
    for (Choice& choice : *choices) {
      if (IsAutomatic(choice)) choice.sharing = std::move(*of_next++);
    }
  }

  static bool IsAutomatic(const Choice& choice) {
    return choice.entry->sources != PatchMatchCfgEntry::Sources::kList;
  }

  PatchMatchCfg ReadCfg() const {
    if (!Exists(path_)) {
      throw Error(ErrorCode::kBadInput,
                  fmt::format("{} is missing: it lists the images to compute; "
                              "give it back, run image_undistorter, or write "
                              "two lines per image: its name, then '__auto__, "
                              "20'",
                              path_.string()));
    }
    return ReadPatchMatchCfg(path_);
  }

  // What the reading found out about the images, one line for each fault.
  void Report() const {
    if (without_sources_.num() > 0) {
      Warn("Ignoring {}, because {} no source images.",
           Describe(without_sources_),
           without_sources_.num() == 1 ? "it has" : "they have");
    }
    if (without_range_.num() > 0) {
      Warn(
          "Ignoring {}: no sparse point and no other view tells the depth "
          "range; set both --PatchMatchStereo.depth_min and "
          "--PatchMatchStereo.depth_max, or --Hpm.depth_ranges.",
          Describe(without_range_));
    }
    if (estimated_.num() > 0) {
      Warn(
          "The depth range of {} is estimated, from the places of cameras and "
          "sparse points: fewer than {} points have a track there. Set both "
          "--PatchMatchStereo.depth_min and --PatchMatchStereo.depth_max if "
          "you know better.",
          Describe(estimated_),
          kEnoughPoints);
    }
    if (unshared_.num() > 0) {
      Warn(
          "Fusion will find nothing in {}: colmap stereo_fusion joins only "
          "images that share tracks of sparse points, and {}. Triangulate "
          "points with the known poses before (colmap feature_extractor, "
          "exhaustive_matcher, point_triangulator), then undistort again.",
          Describe(unshared_),
          unshared_.num() == 1 ? "it shares none" : "they share none");
    }
  }

  [[noreturn]] void FailWithoutProblems(const std::vector<bool>& seen) const {
    const auto num_listed = std::count(seen.begin(), seen.end(), true);
    if (num_listed == 0) {
      throw Error(ErrorCode::kBadInput,
                  fmt::format("{} names no reference image, so there is "
                              "nothing to do; run image_undistorter again, or "
                              "write two lines per image: its name and "
                              "\"__auto__, 20\"",
                              path_.string()));
    }
    std::string remedy = "see the warnings";
    if (without_sources_.num() > 0) {
      remedy =
          "check the poses and the sparse points, or write names of source "
          "images below each reference image, or __all__";
    } else if (without_range_.num() > 0) {
      remedy =
          "set both --PatchMatchStereo.depth_min and "
          "--PatchMatchStereo.depth_max, or --Hpm.depth_ranges";
    }
    throw Error(ErrorCode::kBadInput,
                fmt::format("none of the {} reference images of {} can be "
                            "computed; {}",
                            num_listed,
                            path_.string(),
                            remedy));
  }

  // What stereo_fusion goes by.
  template <class... Args>
  void Warn(fmt::format_string<Args...> format, Args&&... args) const {
    if (log_)
      log_(LogLevel::kWarning,
           fmt::format(format, std::forward<Args>(args)...));
  }

  size_t MaxNumSources() const {
    return std::max(0, options_.max_num_src_images);
  }

  // All wrong names at once: who corrects them by hand wants one run for it.
  void CheckNames(const PatchMatchCfg& cfg) const {
    constexpr size_t kMaxLines = 20;
    std::string message;
    std::vector<int> more;
    const auto check = [&](const std::string& name, int line) {
      if (workspace_.ImageIndex(name) >= 0) return;
      if (!message.empty()) {
        more.push_back(line);
        return;
      }
      message = fmt::format(
          "{}:{}: image {} does not exist in the sparse "
          "model; {}",
          path_.string(),
          line,
          QuotedName(name),
          RemedyForName(workspace_, name));
    };
    for (const PatchMatchCfgEntry& entry : cfg.entries) {
      check(entry.ref_name, entry.line);
      for (const std::string& name : entry.src_names)
        check(name, entry.src_line);
    }
    if (message.empty()) return;
    more.erase(std::unique(more.begin(), more.end()), more.end());
    if (!more.empty()) {
      const size_t num_named = std::min(kMaxLines, more.size());
      message +=
          fmt::format("; likewise in lines {}{}",
                      fmt::join(more.begin(), more.begin() + num_named, ", "),
                      num_named < more.size() ? ", ..." : "");
    }
    throw Error(ErrorCode::kBadInput, message);
  }

  // N of "__auto__, N", else no bound.
  static size_t MostAutomatic(const PatchMatchCfgEntry& entry) {
    const bool is_bound = entry.sources == PatchMatchCfgEntry::Sources::kAuto &&
                          entry.max_num_auto >= 0;
    return is_bound ? static_cast<size_t>(entry.max_num_auto)
                    : std::numeric_limits<size_t>::max();
  }

  // With images that have no picture; for "__auto__, N" so many that N have
  // one.
  std::vector<int> AutomaticSourcesOf(const Choice& choice) const {
    const PatchMatchCfgEntry& entry = *choice.entry;
    if (entry.sources == PatchMatchCfgEntry::Sources::kAll)
      return automatic_.All(choice.ref, choice.sharing, choice.range);
    return automatic_.Best(choice.ref,
                           choice.sharing,
                           choice.range,
                           options_.min_triangulation_angle,
                           std::min(MostAutomatic(entry), MaxNumSources()));
  }

  std::vector<int> ListedSources(const PatchMatchCfgEntry& entry,
                                 int ref) const {
    std::vector<int> sources;
    std::vector<bool> taken(workspace_.num_images(), false);
    taken[ref] = true;
    for (const std::string& name : entry.src_names) {
      const int source = workspace_.ImageIndex(name);
      if (taken[source]) continue;
      taken[source] = true;
      if (workspace_.usable(source)) {
        sources.push_back(source);
      } else {
        Warn(
            "Ignoring source image {} of {}, because its camera cannot be "
            "used.",
            name,
            entry.ref_name);
      }
    }
    return sources;
  }

  const Workspace& workspace_;
  const ProblemOptions& options_;
  const LogSink& log_;
  const CancelToken& cancel_;
  const std::filesystem::path path_;
  const AutomaticSources& automatic_;
  const DepthRanges& ranges_;
  int num_cut_ = 0;
  ImageFault without_sources_;
  ImageFault without_range_;
  ImageFault estimated_;
  ImageFault unshared_;
};

}  // namespace

bool CanBeComputed(const Workspace& workspace, const StereoProblem& problem) {
  return workspace.has_picture(problem.ref_image) &&
         !problem.src_images.empty();
}

std::vector<StereoProblem> ReadProblems(const Workspace& workspace,
                                        const ModelOverview& overview,
                                        const ProblemOptions& options,
                                        const LogSink& log,
                                        const CancelToken& cancel) {
  return ProblemReader(workspace, overview, options, log, cancel).Read();
}

std::vector<StereoProblem> ReadProblems(const Workspace& workspace,
                                        const ProblemOptions& options,
                                        const LogSink& log) {
  const CancelToken never;
  const ModelOverview overview(workspace, options, never);
  return ReadProblems(workspace, overview, options, log, never);
}

}  // namespace hpm
