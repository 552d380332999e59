#include "colmap_plugin/workspace/problem.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/workspace/cfg_check.h"
#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/source_selection.h"
#include "src/base/error.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

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
        selector_(workspace) {}

  std::vector<StereoProblem> Read() {
    const DepthRanges ranges(
        workspace_, options_.depth_min, options_.depth_max);
    std::vector<bool> seen(workspace_.num_images(), false);
    std::vector<StereoProblem> problems;
    const PatchMatchCfg cfg = ReadCfg();
    CheckCfg(workspace_, path_, cfg, log_);
    for (const PatchMatchCfgEntry& entry : cfg.entries) {
      const int ref = IndexOf(entry.ref_name, entry.line);
      std::vector<int> sources =
          Sources(entry, ref);  // also checks the names of the line
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
      const bool has_sources = !sources.empty();
      TakeThoseWithPictures(entry, &sources);
      if (!has_sources) {
        Warn("Ignoring reference image {}, because it has no source images.",
             entry.ref_name);
        continue;
      }
      if (sources.size() > MaxNumSources()) {
        sources.resize(MaxNumSources());
        ++num_cut_;
      }
      const DepthRange range = ranges.ForImage(ref);
      problems.push_back({ref, std::move(sources), range.min, range.max});
    }
    if (num_cut_ > 0 && log_) {
      log_(LogLevel::kInfo,
           fmt::format("{} reference images have more than {} source images; "
                       "the first {} are used.",
                       num_cut_,
                       MaxNumSources(),
                       MaxNumSources()));
    }
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

  std::vector<int> Sources(const PatchMatchCfgEntry& entry, int ref) const {
    switch (entry.sources) {
      case PatchMatchCfgEntry::Sources::kAuto:
        if (entry.max_num_auto == 0) return {};
        return selector_.Select(
            ref, options_.min_triangulation_angle, /*max_num=*/-1);
      case PatchMatchCfgEntry::Sources::kAll:
        return AllSources(ref);
      case PatchMatchCfgEntry::Sources::kList:
        break;
    }
    return ListedSources(entry, ref);
  }

  // The number of "__auto__, N" is met with images that have a picture.
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

  // Overlapping images first, so that the cut to MaxNumSources keeps the useful
  // ones.
  std::vector<int> AllSources(int ref) const {
    std::vector<int> sources =
        selector_.Select(ref, /*min_angle=*/0, /*max_num=*/-1);
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
  int num_cut_ = 0;
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
