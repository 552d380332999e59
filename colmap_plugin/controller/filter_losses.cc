#include "colmap_plugin/controller/filter_losses.h"

#include "src/engine/source_geometry.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr int kStep = 4;  // pixels from one that is looked at to the next

class Judge {
 public:
  Judge(const ViewSet& views, const FilterParams& filter, bool geometric)
      : ref_(views.ref.camera),
        max_cos_(std::cos(filter.min_triangulation_angle)),
        max_error_(filter.max_reprojection_error),
        geometric_(geometric) {
    for (const View& src : views.srcs) {
      centers_.push_back(CenterOf(ref_, src));
      depth_views_.push_back(DepthViewOf(ref_, src));
    }
  }

  // That took the last source of a pixel which none confirms.
  FilterCriterion Last(const Plane& plane, int col, int row) const {
    auto last = FilterCriterion::kFacing;
    for (size_t j = 0; j < centers_.size(); ++j)
      last = std::max(last, TakenBy(j, plane, col, row));
    return last;
  }

 private:
  FilterCriterion TakenBy(size_t j,
                          const Plane& plane,
                          int col,
                          int row) const {
    const auto x = static_cast<float>(col), y = static_cast<float>(row);
    const Vec3f ray = RayAt(ref_, x, y);
    const Vec3f point = DepthOnRay(plane, ray) * ray;
    const Sight sight = SightOf(point, plane.normal, centers_[j], max_cos_);
    if (sight == Sight::kBack) return FilterCriterion::kFacing;
    if (sight == Sight::kSmallAngle) return FilterCriterion::kAngle;
    if (!geometric_) return FilterCriterion::kCorrelation;
    if (!depth_views_[j].HasDepth()) return FilterCriterion::kGeometry;
    const Reprojection there =
        Reproject(depth_views_[j], SlopeOf(ref_, plane), x, y);
    const float error = ReprojectionError(there, x, y, 2 * max_error_ + 1);
    return error > max_error_ ? FilterCriterion::kGeometry
                              : FilterCriterion::kCorrelation;
  }

  const Camera& ref_;
  const float max_cos_;
  const float max_error_;
  const bool geometric_;
  std::vector<Vec3f> centers_;  // of the sources, reference camera frame
  std::vector<DepthView> depth_views_;
};

// What to call most of an image's pixels. A range given by hand may well be
// meant to keep little.
double Most(FilterCriterion criterion) {
  return criterion == FilterCriterion::kRange ? 0.95 : 0.5;
}

// With the values that were asked for.
std::string Reason(FilterCriterion criterion,
                   const ControllerOptions& options) {
  const PatchMatchStereoOptions& colmap = options.patch_match;
  switch (criterion) {
    case FilterCriterion::kFacing:
      return "all sources look at the back of the surface found";
    case FilterCriterion::kAngle:
      return fmt::format("no source sees them under {:g} degrees or more",
                         colmap.filter_min_triangulation_angle);
    case FilterCriterion::kGeometry:
      return fmt::format("the depths of no source agree within {:g} pixels",
                         colmap.filter_geom_consistency_max_cost);
    case FilterCriterion::kCorrelation:
      return fmt::format("no source correlates by {:g} or more",
                         colmap.filter_min_ncc);
    case FilterCriterion::kNumConsistent:
      return fmt::format("fewer than {} sources confirm them",
                         colmap.filter_min_num_consistent);
    case FilterCriterion::kUnexplained:
      return "nothing but chance decides there, as in a sky: no texture, no "
             "plane that explains it, and many sources disagree";
    case FilterCriterion::kRange:
      break;
  }
  return "they lie outside the range that was given";
}

}  // namespace

nlohmann::json ToJson(const FilterLosses& losses) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [criterion, share] : losses) json[NameOf(criterion)] = share;
  return json;
}

FilterLosses CountFilterLosses(const ViewSet& views,
                               const HypothesisMap& map,
                               const std::vector<uint32_t>& consistent,
                               const std::vector<bool>& keep,
                               const FilterParams& filter,
                               bool geometric) {
  const Judge judge(views, filter, geometric);
  std::map<FilterCriterion, int> counts;
  int num_looked_at = 0;
  for (int row = std::min(kStep, map.height) / 2; row < map.height;
       row += kStep) {
    for (int col = std::min(kStep, map.width) / 2; col < map.width;
         col += kStep) {
      ++num_looked_at;
      const size_t at = static_cast<size_t>(row) * map.width + col;
      if (keep[at]) continue;
      // What is masked is not lost.
      if (views.ref.image->IsGap(at)) continue;
      const int num = __builtin_popcount(consistent[at]);
      ++counts[num == 0 ? judge.Last(map.planes[at], col, row)
               : num < filter.min_num_consistent
                   ? FilterCriterion::kNumConsistent
                   : FilterCriterion::kUnexplained];
    }
  }
  FilterLosses losses;
  for (const auto& [criterion, count] : counts)
    losses[criterion] = static_cast<double>(count) / num_looked_at;
  return losses;
}

std::vector<std::string> FilterWarnings(
    const std::map<std::string, FilterLosses>& losses_of_images,
    const ControllerOptions& options) {
  struct Found {
    int num_images = 0;
    std::string first;
    double share = 0;
  };
  std::map<FilterCriterion, Found> found;
  for (const auto& [image, losses] : losses_of_images) {
    for (const auto& [criterion, share] : losses) {
      if (!(share > Most(criterion))) continue;
      Found& here = found[criterion];
      if (here.num_images++ == 0) here = {1, image, share};
    }
  }
  std::vector<std::string> lines;
  lines.reserve(found.size());
  for (const auto& [criterion, here] : found) {
    lines.push_back(fmt::format(
        "{} of {} images lost most of their pixels to the filter ({}: {:.0f} "
        "%), because {}: {}",
        here.num_images,
        losses_of_images.size(),
        here.first,
        100 * here.share,
        Reason(criterion, options),
        RemedyFor(criterion)));
  }
  return lines;
}

}  // namespace hpm
