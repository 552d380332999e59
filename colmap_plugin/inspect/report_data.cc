#include "colmap_plugin/inspect/report_data.h"

#include "colmap_plugin/inspect/thumbnails.h"
#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// Empty for no values.
std::optional<DepthSpan> SpanOf(std::vector<float> depths) {
  depths.erase(
      std::remove_if(
          depths.begin(), depths.end(), [](float z) { return !(z > 0); }),
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

nlohmann::json ReadRunRecord(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return nullptr;
  nlohmann::json json =
      nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false);
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
           const std::vector<StereoProblem>& problems,
           ReportData* data)
      : workspace_(workspace), problems_(problems), data_(data) {
    for (int p = 0; p < static_cast<int>(problems.size()); ++p) {
      for (const int src : problems[p].src_images)
        num_shared_[{problems[p].ref_image, src}] = 0;
    }
    depths_.resize(workspace.num_images());
    const SparsePoints& points = workspace.model().points;
    for (size_t i = 0; i < points.size(); ++i) Count(points[i]);
  }

  void GatherImage(size_t p) const {
    const StereoProblem& problem = problems_[p];
    const int image = problem.ref_image;
    ReportedImage& to = data_->images[p];
    to.name = workspace_.ImageName(image);
    to.width = workspace_.camera(image).width;
    to.height = workspace_.camera(image).height;
    for (const int src : problem.src_images) {
      to.sources.push_back(
          {workspace_.ImageName(src), num_shared_.at({image, src})});
    }
    to.sparse_depths = SpanOf(depths_[image]);
    to.picture = PictureThumbnail(workspace_.ImagePath(image));
    AddStatistics(&to);
    AddMaps(image, &to);
  }

 private:
  void Count(const SparsePoint& point) {
    const std::set<int> track(point.track.begin(), point.track.end());
    for (const int a : track) {
      if (!workspace_.usable(a)) continue;
      depths_[a].push_back(static_cast<float>(workspace_.Depth(a, point.xyz)));
      for (const int b : track) {
        const auto pair = num_shared_.find({a, b});
        if (pair != num_shared_.end()) ++pair->second;
      }
    }
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
    double seconds = 0;
    // All stages of the last run, where it made this image.
    const auto& run = data_->run;
    if (run.is_object() && run.contains("images") &&
        run["images"].contains(to->name)) {
      for (const auto& [stage, result] : run["images"][to->name].items())
        seconds += SumOf(result.value("seconds", nlohmann::json()));
      to->seconds = seconds;
    }
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

  const Workspace& workspace_;
  const std::vector<StereoProblem>& problems_;
  ReportData* data_;
  std::map<std::pair<int, int>, int> num_shared_;
  std::vector<std::vector<float>> depths_;  // of the sparse points, per image
};

}  // namespace

ReportData GatherReport(const ControllerOptions& options,
                        const LogSink& log,
                        const CancelToken& cancel) {
  const Workspace workspace(options.workspace, log, cancel);
  const std::vector<StereoProblem> problems =
      ReadProblems(workspace, options.problems, log);
  ReportData data;
  data.workspace = options.workspace.path.string();
  data.stereo_path = workspace.StereoPath();
  data.stage =
      options.patch_match.geom_consistency ? "geometric" : "photometric";
  data.run = ReadRunRecord(workspace.StatePath() / "run.json");
  data.images.resize(problems.size());
  const Gatherer gatherer(workspace, problems, &data);
  tbb::parallel_for(size_t{0}, problems.size(), [&](size_t p) {
    cancel.ThrowIfCancelled();
    gatherer.GatherImage(p);
  });
  return data;
}

}  // namespace hpm
