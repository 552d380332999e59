#include "src/engine/needed_views.h"

#include "src/engine/source_geometry.h"

#include <algorithm>
#include <cmath>

namespace hpm {
namespace {

// What a source finds nearer than this share of the depth of a plane hides it;
// what is left is noise and the plane's own error.
constexpr float kHidden = 0.8f;

bool IsHidden(const View& src, float u, float v, float z) {
  if (src.inverse_depth == nullptr) return false;
  return kHidden * z *
             InterpolateInverseDepth(src.inverse_depth->View(),
                                     src.camera.width,
                                     src.camera.height,
                                     u,
                                     v) >
         1;
}

}  // namespace

NeededViews::NeededViews(const ViewSet& views,
                         const HypothesisMap& map,
                         const FilterParams& filter,
                         double min_agreement,
                         bool geometric)
    : views_(views),
      map_(map),
      min_num_consistent_(filter.min_num_consistent),
      min_agreement_(min_agreement),
      max_cos_(std::cos(filter.min_triangulation_angle)),
      geometric_(geometric) {
  for (const View& src : views.srcs) {
    warps_.push_back(MakeViewWarp(views.ref.camera, src.camera));
    centers_.push_back(CenterOf(views.ref.camera, src));
  }
}

int NeededViews::At(size_t at) const {
  if (map_.unexplained.empty() || !map_.unexplained[at])
    return min_num_consistent_;
  return std::max(
      min_num_consistent_,
      static_cast<int>(std::ceil(min_agreement_ * CountSeeing(at))));
}

int NeededViews::CountSeeing(size_t at) const {
  const size_t ref_col = at % map_.width, ref_row = at / map_.width;
  const auto x = static_cast<float>(ref_col);
  const auto y = static_cast<float>(ref_row);
  const Plane& plane = map_.planes[at];
  const Vec3f ray = RayAt(views_.ref.camera, x, y);
  const Vec3f point = DepthOnRay(plane, ray) * ray;
  const PlaneSlope slope = SlopeOf(views_.ref.camera, plane);
  const Vec3f world = WorldFromCam(views_.ref.camera, point);
  int count = 0;
  for (size_t j = 0; j < warps_.size(); ++j) {
    const View& src = views_.srcs[j];
    if (geometric_ && src.inverse_depth == nullptr) continue;
    if (SightOf(point, plane.normal, centers_[j], max_cos_) != Sight::kFront)
      continue;
    float u, v;
    if (!IsSeen(warps_[j], slope, x, y, &u, &v)) continue;
    const GrayImage& image = *src.image;
    const auto pixel = [](float position, int size) {
      return std::clamp(
          static_cast<int>(std::floor(position + 0.5f)), 0, size - 1);
    };
    const int col = pixel(u, image.width), row = pixel(v, image.height);
    if (image.IsGap(static_cast<size_t>(row) * image.width + col)) continue;
    count += !IsHidden(src, u, v, CamFromWorld(src.camera, world).z);
  }
  return count;
}

}  // namespace hpm
