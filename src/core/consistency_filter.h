// COLMAP's filter of finished maps: a source counts if it sees the surface from
// its front, under a sufficient angle, with a sufficient NCC and, after a
// geometric pass, with a small reprojection error.
#pragma once

#include "src/core/visit.h"

namespace hpm {

struct FilterParams {
  float min_ncc;                  // -1: not looked at
  float min_triangulation_angle;  // radians
  float max_reprojection_error;   // pixels
  int min_num_consistent;
};

enum class Sight {
  kBack,        // the source looks at the back of the surface
  kSmallAngle,  // it sees the front, from about where the reference does
  kFront,
};

// How a source whose camera centre is `src_center` sees the surface of this
// normal at `point`; all in the reference camera frame. `max_cos`: of the
// smallest angle between the rays from the point to both cameras.
HPM_HD Sight SightOf(const Vec3f& point,
                     const Vec3f& normal,
                     const Vec3f& src_center,
                     float max_cos) {
  const Vec3f to_src = src_center - point;
  const float distance = Norm(to_src);
  if (!(distance > 0) || Dot(to_src, normal) <= 0) return Sight::kBack;
  const Vec3f to_ref = -Normalized(point);
  return Dot(to_src, to_ref) > max_cos * distance ? Sight::kSmallAngle
                                                  : Sight::kFront;
}

// Bit j: source view j is consistent. src_centers: camera centres in the
// reference camera frame.
template <class Cost>
HPM_HD uint32_t ConsistentViews(const VisitParams& params,
                                const FilterParams& filter,
                                const Vec3f* src_centers,
                                const Cost& cost,
                                const Plane& plane,
                                int col,
                                int row) {
  const Vec3f ray =
      RayAt(params.ref, static_cast<float>(col), static_cast<float>(row));
  const Vec3f point = DepthOnRay(plane, ray) * ray;
  const float max_cos = cosf(filter.min_triangulation_angle);
  uint8_t views[kMaxViews];
  int num_views = 0;
  for (int j = 0; j < params.num_views; ++j) {
    if (SightOf(point, plane.normal, src_centers[j], max_cos) != Sight::kFront)
      continue;
    if (params.geometric && !cost.HasDepth(j)) continue;
    views[num_views++] = static_cast<uint8_t>(j);
  }
  if (params.geometric && num_views > 0) {
    float errors[kMaxViews];
    cost.GeometricErrors(&plane, 1, views, num_views, errors);
    int num_near = 0;
    for (int k = 0; k < num_views; ++k) {
      if (!(errors[k] > filter.max_reprojection_error))
        views[num_near++] = views[k];
    }
    num_views = num_near;
  }
  uint32_t mask = 0;
  if (filter.min_ncc <= -1) {  // every correlation will do
    for (int k = 0; k < num_views; ++k) mask |= 1u << views[k];
    return mask;
  }
  if (num_views == 0) return mask;
  float costs[kMaxViews];
  cost.Photometric(&plane, 1, views, num_views, costs);
  for (int k = 0; k < num_views; ++k) {
    if (1 - costs[k] >= filter.min_ncc) mask |= 1u << views[k];
  }
  return mask;
}

}  // namespace hpm
