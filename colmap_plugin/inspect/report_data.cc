#include "colmap_plugin/inspect/report_data.h"

#include "colmap_plugin/controller/run_budget.h"
#include "colmap_plugin/controller/unreadable_images.h"
#include "colmap_plugin/inspect/thumbnails.h"
#include "colmap_plugin/workspace/model_overview.h"
#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/source_selection.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/base/input_file.h"
#include "src/engine/memory_plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace hpm {
namespace {

// Empty for no values.
std::optional<DepthSpan> SpanOf(std::vector<float> depths) {
  const auto is_no_depth = [](float z) { return !(z > 0 && std::isfinite(z)); };
  depths.erase(std::remove_if(depths.begin(), depths.end(), is_no_depth),
               depths.end());
  if (depths.empty()) return std::nullopt;
  const auto at = [&](double share) {
    const auto middle =
        depths.begin() +
        static_cast<ptrdiff_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), middle, depths.end());
    return *middle;
  };
  return DepthSpan{at(0.02), at(0.98)};
}

// Null if there is none that can be used.
nlohmann::json ReadRunRecord(const std::filesystem::path& path) {
  constexpr uint64_t kMaxBytes = 1 << 30;
  std::string text;
  try {
    text = ReadWholeFile(path, kMaxBytes);
  } catch (const Error&) {
    return nullptr;
  }
  nlohmann::json json =
      nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  return json.is_object() ? json : nlohmann::json(nullptr);
}

double SumOf(const nlohmann::json& phases) {
  double sum = 0;
  if (!phases.is_object()) return sum;
  for (const auto& [phase, seconds] : phases.items()) {
    if (seconds.is_number()) sum += seconds.get<double>();
  }
  return sum;
}

class Gatherer {
 public:
  Gatherer(const Workspace& workspace,
           const ModelOverview& overview,
           const std::vector<StereoProblem>& problems,
           const CancelToken& cancel,
           ReportData* data)
      : workspace_(workspace),
        tracks_(overview.tracks()),
        selector_(workspace, tracks_),
        problems_(problems),
        cancel_(cancel),
        data_(data) {}

  void GatherImage(size_t p) const {
    cancel_.ThrowIfCancelled();
    const StereoProblem& problem = problems_[p];
    const int image = problem.ref_image;
    ReportedImage& to = data_->images[p];
    to.name = workspace_.ImageName(image);
    to.width = workspace_.camera(image).width;
    to.height = workspace_.camera(image).height;
    AddSources(problem, &to);
    AddSparseDepths(image, &to);
    AddStatistics(&to);
    AddMaps(image, &to);
    if (to.why_not.empty() && !CanBeComputed(workspace_, problem)) {
      to.why_not = std::string(to.has_maps ? "maps of an earlier run: " : "") +
                   "no picture of it or of any source can be used";
    }
    if (to.has_maps) AddConfidence(image, &to);
  }

  // Of the worst images, where there are too many: those with the smallest
  // share of pixels with a depth. Decoders take much more memory than pictures.
  void GatherPictures() const {
    std::vector<size_t> shown(data_->images.size());
    std::iota(shown.begin(), shown.end(), size_t{0});
    if (shown.size() > kMaxPictured) {
      std::stable_sort(shown.begin(), shown.end(), [&](size_t a, size_t b) {
        return Rank(data_->images[a]) < Rank(data_->images[b]);
      });
      for (size_t i = kMaxPictured; i < shown.size(); ++i) {
        ReportedImage& hidden = data_->images[shown[i]];
        hidden.depth.clear();
        hidden.normal.clear();
        hidden.confidence.clear();
      }
      shown.resize(kMaxPictured);
    }
    uint64_t largest = 0;
    const auto cannot_be_decoded = [&](size_t p) {
      const int image = problems_[p].ref_image;
      const uint64_t bytes = DecodedBytes(workspace_, image);
      if (!workspace_.has_picture(image) || bytes > MemoryLimit()) return true;
      largest = std::max(largest, bytes);
      return false;
    };
    shown.erase(std::remove_if(shown.begin(), shown.end(), cannot_be_decoded),
                shown.end());
    tbb::task_arena(ThreadsToDecode(largest)).execute([&] {
      tbb::parallel_for(size_t{0}, shown.size(), [&](size_t i) {
        cancel_.ThrowIfCancelled();
        data_->images[shown[i]].picture = PictureThumbnail(
            workspace_.ImagePath(problems_[shown[i]].ref_image));
      });
    });
  }

 private:
  static double Rank(const ReportedImage& image) {
    return image.has_maps ? image.valid_share.value_or(1) : 2;
  }

  void AddSources(const StereoProblem& problem, ReportedImage* to) const {
    std::map<int, uint64_t> num_shared;
    for (const SourceCandidate& candidate :
         selector_.Candidates(problem.ref_image, /*min_angle=*/0, cancel_)) {
      num_shared[candidate.image] = candidate.num_shared;
    }
    for (const int src : problem.src_images)
      to->sources.push_back({workspace_.ImageName(src), num_shared[src]});
  }

  void AddSparseDepths(int image, ReportedImage* to) const {
    if (!workspace_.usable(image)) return;
    const SparsePoints& points = workspace_.model().points;
    std::vector<float> depths;
    const auto visit = [&](size_t i, size_t) {
      depths.push_back(
          static_cast<float>(workspace_.Depth(image, points[i].xyz)));
      return !cancel_.cancelled();
    };
    tracks_.ForEachPoint(image, TrackIndex::Reads::kPoints, visit);
    cancel_.ThrowIfCancelled();
    to->sparse_depths = SpanOf(std::move(depths));
  }

  void AddStatistics(ReportedImage* to) const {
    const std::optional<Stamp> stamp =
        ReadStamp(workspace_.StatePath(), to->name, data_->stage);
    if (!stamp) return;
    const nlohmann::json& statistics = stamp->statistics;
    const auto losses = statistics.find("filter_losses");
    if (losses != statistics.end() && losses->is_object()) {
      for (const auto& [criterion, share] : losses->items()) {
        if (share.is_number()) to->losses[criterion] = share.get<double>();
      }
    }
    const auto share = statistics.find("valid_pixel_share");
    if (share != statistics.end() && share->is_number())
      to->valid_share = share->get<double>();
    to->costs = CostHistogramFrom(Member(statistics, "cost_histogram"));
    to->seconds = SecondsOf(to->name);
  }

  // All stages of the last run, where it made this image.
  std::optional<double> SecondsOf(const std::string& name) const {
    const nlohmann::json& stages = Member(Member(data_->run, "images"), name);
    if (!stages.is_object()) return std::nullopt;
    double seconds = 0;
    for (const nlohmann::json& result : stages)
      seconds += SumOf(Member(result, "seconds"));
    return seconds;
  }

  void AddMaps(int image, ReportedImage* to) const {
    const auto path = workspace_.MapPath(image, MapKind::kDepth, data_->stage);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return;
    try {
      const Map depth = ReadThinned(path);
      const Map normal = ReadThinned(
          workspace_.MapPath(image, MapKind::kNormal, data_->stage));
      const MapHeader header = ReadMapHeader(path);
      to->width = header.width;
      to->height = header.height;
      if (depth.channels != 1 || normal.channels != 3) {
        to->why_not = path.string() + " or its normal map is damaged";
        return;
      }
      to->depths = SpanOf(depth.data);
      to->depth = DepthThumbnail(depth);
      to->normal = NormalThumbnail(normal);
      to->has_maps = true;
      if (!to->valid_share) {
        to->valid_share =
            static_cast<double>(std::count_if(depth.data.begin(),
                                              depth.data.end(),
                                              [](float z) { return z > 0; })) /
            static_cast<double>(depth.data.size());
      }
    } catch (const Error& error) {
      to->why_not = error.what();
    }
  }

  // A damaged one is no fault of the depth.
  void AddConfidence(int image, ReportedImage* to) const {
    const auto path =
        workspace_.MapPath(image, MapKind::kConfidence, data_->stage);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return;
    try {
      const Map confidence = ReadThinned(path);
      if (confidence.channels == 1)
        to->confidence = ConfidenceThumbnail(confidence);
    } catch (const Error&) {
      return;
    }
  }

  const Workspace& workspace_;
  const TrackIndex& tracks_;
  const SourceSelector selector_;
  const std::vector<StereoProblem>& problems_;
  const CancelToken& cancel_;
  ReportData* data_;
};

}  // namespace

const nlohmann::json& Member(const nlohmann::json& json,
                             const std::string& key) {
  static const nlohmann::json null;
  const auto it = json.find(key);
  return it == json.end() ? null : *it;
}

ReportData GatherReport(const ControllerOptions& options,
                        const LogSink& log,
                        const CancelToken& cancel) {
  Workspace workspace(options.workspace, log, cancel);
  ImageContents contents(workspace);
  for (const std::string& line :
       DropUnreadable(&workspace, &contents, cancel)) {
    if (log) log(LogLevel::kWarning, line);
  }
  const ModelOverview overview(workspace, options.problems, cancel);
  const std::vector<StereoProblem> problems =
      ReadProblems(workspace, overview, options.problems, log, cancel);
  ReportData data;
  data.workspace = options.workspace.path.string();
  data.stage =
      options.patch_match.geom_consistency ? "geometric" : "photometric";
  data.run = ReadRunRecord(workspace.StatePath() / "run.json");
  data.images.resize(problems.size());
  const Gatherer gatherer(workspace, overview, problems, cancel, &data);
  tbb::parallel_for(
      size_t{0}, problems.size(), [&](size_t p) { gatherer.GatherImage(p); });
  gatherer.GatherPictures();
  return data;
}

}  // namespace hpm
