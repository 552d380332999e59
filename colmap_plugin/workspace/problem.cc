#include "colmap_plugin/workspace/problem.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/workspace/cfg_check.h"
#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/overlap_selection.h"
#include "colmap_plugin/workspace/source_selection.h"
#include "src/base/error.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

// Images that share a fault, for one line about all of them.
struct Affected {
  int count = 0;
  std::string first;

  void Add(const std::string& name) {
    if (count++ == 0) first = name;
  }
};

// "reference image a.jpg" or "3 reference images (the first: a.jpg)".
std::string Describe(const Affected& images) {
  if (images.count == 1) return "reference image " + images.first;
  return fmt::format(
      "{} reference images (the first: {})", images.count, images.first);
}

class ProblemReader {
 public:
  ProblemReader(const Workspace& workspace,
                const ProblemOptions& options,
                const LogSink& log)
      : workspace_(workspace),
        options_(options),
        log_(log),
        path_(options.config_path.empty() ? workspace.PatchMatchCfgPath()
                                          : options.config_path),
        selector_(workspace),
        ranges_(workspace, options.depth_min, options.depth_max) {
    for (int i = 0; i < workspace.num_images(); ++i)
      badly_tracked_.push_back(selector_.NumSharedPoints(i) < kEnoughPoints);
  }

  std::vector<StereoProblem> Read() {
    std::vector<bool> seen(workspace_.num_images(), false);
    std::vector<StereoProblem> problems;
    const PatchMatchCfg cfg = ReadCfg();
    CheckCfg(workspace_, path_, cfg, log_);
    for (const PatchMatchCfgEntry& entry : cfg.entries) {
      const int ref = IndexOf(entry.ref_name, entry.line);
      CheckSourceNames(entry);
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
      const std::optional<DepthRange> range = ranges_.ForImage(ref);
      std::vector<int> sources = Sources(entry, ref, range);
      if (sources.empty()) {
        without_sources_.Add(entry.ref_name);
        continue;
      }
      TakeThoseWithPictures(entry, &sources);
      if (!range) {
        without_range_.Add(entry.ref_name);
        continue;
      }
      if (ranges_.IsEstimated(ref)) estimated_.Add(entry.ref_name);
      if (!SharesPoints(ref)) unshared_.Add(entry.ref_name);
      if (sources.size() > MaxNumSources()) {
        sources.resize(MaxNumSources());
        ++num_cut_;
      }
      StereoProblem problem;
      problem.ref_image = ref;
      problem.src_images = std::move(sources);
      problem.depth_min = range->min;
      problem.depth_max = range->max;
      problem.published = ranges_.Published();
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
  PatchMatchCfg ReadCfg() const {
    std::error_code ignored;
    if (!std::filesystem::exists(path_, ignored)) {
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
    if (without_sources_.count > 0) {
      Warn("Ignoring {}, because {} no source images.",
           Describe(without_sources_),
           without_sources_.count == 1 ? "it has" : "they have");
    }
    if (without_range_.count > 0) {
      Warn(
          "Ignoring {}: no sparse point and no other view tells the depth "
          "range; set both --PatchMatchStereo.depth_min and "
          "--PatchMatchStereo.depth_max.",
          Describe(without_range_));
    }
    if (estimated_.count > 0) {
      Warn(
          "The depth range of {} is estimated, from the places of cameras and "
          "sparse points: fewer than {} points have a track there. Set both "
          "--PatchMatchStereo.depth_min and --PatchMatchStereo.depth_max if "
          "you know better.",
          Describe(estimated_),
          kEnoughPoints);
    }
    if (unshared_.count > 0) {
      Warn(
          "Fusion will find nothing in {}: colmap stereo_fusion joins only "
          "images that share tracks of sparse points, and {}. Triangulate "
          "points with the known poses before (colmap feature_extractor, "
          "exhaustive_matcher, point_triangulator), then undistort again.",
          Describe(unshared_),
          unshared_.count == 1 ? "it shares none" : "they share none");
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
    if (without_sources_.count > 0) {
      remedy =
          "check the poses and the sparse points, or write names of source "
          "images below each reference image, or __all__";
    } else if (without_range_.count > 0) {
      remedy =
          "set both --PatchMatchStereo.depth_min and "
          "--PatchMatchStereo.depth_max";
    }
    throw Error(ErrorCode::kBadInput,
                fmt::format("none of the {} reference images of {} can be "
                            "computed; {}",
                            num_listed,
                            path_.string(),
                            remedy));
  }

  // What stereo_fusion goes by.
  bool SharesPoints(int image) const {
    return selector_.NumSharedPoints(image) > 0;
  }

  template <class... Args>
  void Warn(fmt::format_string<Args...> format, Args&&... args) const {
    if (log_)
      log_(LogLevel::kWarning,
           fmt::format(format, std::forward<Args>(args)...));
  }

  size_t MaxNumSources() const {
    return std::max(0, options_.max_num_src_images);
  }

  int IndexOf(const std::string& name, int line) const {
    const int index = workspace_.ImageIndex(name);
    if (index < 0) {
      throw Error(ErrorCode::kBadInput,
                  fmt::format("{}:{}: image {} does not exist in the sparse "
                              "model; {}",
                              path_.string(),
                              line,
                              QuotedName(name),
                              RemedyForName(workspace_, name)));
    }
    return index;
  }

  void CheckSourceNames(const PatchMatchCfgEntry& entry) const {
    for (const std::string& name : entry.src_names)
      IndexOf(name, entry.src_line);
  }

  // With images that have no picture; for "__auto__, N" so many that N have
  // one.
  std::vector<int> Sources(const PatchMatchCfgEntry& entry,
                           int ref,
                           const std::optional<DepthRange>& range) const {
    switch (entry.sources) {
      case PatchMatchCfgEntry::Sources::kAuto:
        return AutoSources(entry, ref, range);
      case PatchMatchCfgEntry::Sources::kAll:
        return AllSources(ref, range);
      case PatchMatchCfgEntry::Sources::kList:
        break;
    }
    return ListedSources(entry, ref);
  }

  void TakeThoseWithPictures(const PatchMatchCfgEntry& entry,
                             std::vector<int>* sources) const {
    const auto without = [this](int i) { return !workspace_.has_picture(i); };
    sources->erase(std::remove_if(sources->begin(), sources->end(), without),
                   sources->end());
    if (entry.sources != PatchMatchCfgEntry::Sources::kAuto) return;
    const auto max_num = static_cast<size_t>(entry.max_num_auto);
    if (entry.max_num_auto >= 0 && sources->size() > max_num)
      sources->resize(max_num);
  }

  std::vector<int> AutoSources(const PatchMatchCfgEntry& entry,
                               int ref,
                               const std::optional<DepthRange>& range) const {
    if (entry.max_num_auto == 0) return {};
    std::vector<int> sources =
        selector_.Select(ref, options_.min_triangulation_angle, /*max_num=*/-1);
    const size_t max_num = entry.max_num_auto < 0
                               ? MaxNumSources()
                               : static_cast<size_t>(entry.max_num_auto);
    // Images whose tracks tell too little are not missed by others, either.
    AddOverlapping(ref,
                   range,
                   options_.min_triangulation_angle,
                   badly_tracked_[ref] ? all_ : badly_tracked_,
                   max_num,
                   &sources);
    return sources;
  }

  // Views that look at the same place, behind those that share points, until
  // max_num have a picture.
  void AddOverlapping(int ref,
                      const std::optional<DepthRange>& range,
                      double min_angle,
                      const std::vector<bool>& candidates,
                      size_t max_num,
                      std::vector<int>* sources) const {
    auto num_with_picture = static_cast<size_t>(
        std::count_if(sources->begin(), sources->end(), [this](int i) {
          return workspace_.has_picture(i);
        }));
    if (!range || num_with_picture >= max_num) return;
    for (const int image :
         overlap_.Select(ref, *range, min_angle, candidates)) {
      if (num_with_picture >= max_num) break;
      if (std::find(sources->begin(), sources->end(), image) !=
          sources->end()) {
        continue;
      }
      sources->push_back(image);
      num_with_picture += workspace_.has_picture(image);
    }
  }

  // Overlapping images first, so that the cut to MaxNumSources keeps the useful
  // ones.
  std::vector<int> AllSources(int ref,
                              const std::optional<DepthRange>& range) const {
    std::vector<int> sources =
        selector_.Select(ref, /*min_angle=*/0, /*max_num=*/-1);
    if (badly_tracked_[ref]) {
      AddOverlapping(ref, range, /*min_angle=*/0, all_, all_.size(), &sources);
    }
    std::vector<bool> taken(workspace_.num_images(), false);
    taken[ref] = true;
    for (const int source : sources) taken[source] = true;
    for (int i = 0; i < workspace_.num_images(); ++i) {
      if (!taken[i] && workspace_.usable(i)) sources.push_back(i);
    }
    return sources;
  }

  std::vector<int> ListedSources(const PatchMatchCfgEntry& entry,
                                 int ref) const {
    std::vector<int> sources;
    std::vector<bool> taken(workspace_.num_images(), false);
    taken[ref] = true;
    for (const std::string& name : entry.src_names) {
      const int source = IndexOf(name, entry.src_line);
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
  const std::filesystem::path path_;
  const SourceSelector selector_;
  const DepthRanges ranges_;
  const OverlapSelector overlap_{workspace_};
  const std::vector<bool> all_ =
      std::vector<bool>(workspace_.num_images(), true);
  // Images that share too few points with others for a choice of sources.
  std::vector<bool> badly_tracked_;
  int num_cut_ = 0;
  Affected without_sources_;
  Affected without_range_;
  Affected estimated_;
  Affected unshared_;
};

}  // namespace

bool CanBeComputed(const Workspace& workspace, const StereoProblem& problem) {
  return workspace.has_picture(problem.ref_image) &&
         !problem.src_images.empty();
}

std::vector<StereoProblem> ReadProblems(const Workspace& workspace,
                                        const ProblemOptions& options,
                                        const LogSink& log) {
  return ProblemReader(workspace, options, log).Read();
}

}  // namespace hpm
