#include "src/prior/planar_prior.h"

#include "src/prior/nearest_points.h"
#include "src/prior/triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hpm {
namespace {

constexpr Plane kNoPlane = {{0, 0, 0}, 0};

// Twice the signed area in pixels squared; exact on pixel coordinates.
int64_t DoubledArea(const CrediblePoint& a,
                    const CrediblePoint& b,
                    const CrediblePoint& c) {
  return static_cast<int64_t>(b.col - a.col) * (c.row - a.row) -
         static_cast<int64_t>(b.row - a.row) * (c.col - a.col);
}

// Plane through three points, facing the camera; kNoPlane if they are (nearly)
// in line with each other or with the camera.
Plane PlaneThrough(const CrediblePoint& a,
                   const CrediblePoint& b,
                   const CrediblePoint& c) {
  const Vec3f cross = Cross(b.position - a.position, c.position - a.position);
  const float norm = Norm(cross);
  if (!(norm > 0)) return kNoPlane;
  Vec3f normal = (1 / norm) * cross;
  float distance = -Dot(normal, a.position);
  if (distance < 0) {
    normal = -normal;
    distance = -distance;
  }
  if (!std::isfinite(distance) || !(distance > 0)) return kNoPlane;
  return {normal, distance};
}

bool IsInRange(const Camera& camera,
               const Plane& plane,
               int col,
               int row,
               const PriorRange& range) {
  const float z =
      DepthAt(camera, plane, static_cast<float>(col), static_cast<float>(row));
  return z >= range.depth_min && z <= range.depth_max;
}

// Pixels on a shared edge belong to the triangle that comes first.
void FillTriangle(const Camera& camera,
                  const std::array<const CrediblePoint*, 3>& corners,
                  const PriorRange& range,
                  std::vector<Plane>* planes,
                  std::vector<bool>* covered) {
  const auto& [a, b, c] = corners;
  const int64_t area = DoubledArea(*a, *b, *c);
  if (area == 0) return;
  const Plane plane = PlaneThrough(*a, *b, *c);
  const int64_t sign = area > 0 ? 1 : -1;
  const auto [left, right] = std::minmax({a->col, b->col, c->col});
  const auto [top, bottom] = std::minmax({a->row, b->row, c->row});
  for (int row = top; row <= bottom; ++row) {
    for (int col = left; col <= right; ++col) {
      const CrediblePoint p = {col, row, {0, 0, 0}};
      if (sign * DoubledArea(*a, *b, p) < 0 ||
          sign * DoubledArea(*b, *c, p) < 0 ||
          sign * DoubledArea(*c, *a, p) < 0) {
        continue;
      }
      const size_t at = static_cast<size_t>(row) * camera.width + col;
      if ((*covered)[at]) continue;
      (*covered)[at] = true;
      if (plane.distance > 0 && IsInRange(camera, plane, col, row, range))
        (*planes)[at] = plane;
    }
  }
}

// The first triple of the nearest points that is not collinear: all triples of
// the five nearest before any with the sixth, as in the paper's authors' code.
Plane NearestPlane(const std::vector<CrediblePoint>& points,
                   const int* nearest) {
  constexpr int kTriples[20][3] = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 2, 3},
                                   {0, 2, 4}, {0, 3, 4}, {1, 2, 3}, {1, 2, 4},
                                   {1, 3, 4}, {2, 3, 4}, {0, 1, 5}, {0, 2, 5},
                                   {0, 3, 5}, {0, 4, 5}, {1, 2, 5}, {1, 3, 5},
                                   {1, 4, 5}, {2, 3, 5}, {2, 4, 5}, {3, 4, 5}};
  for (const auto& triple : kTriples) {
    const CrediblePoint& a = points[nearest[triple[0]]];
    const CrediblePoint& b = points[nearest[triple[1]]];
    const CrediblePoint& c = points[nearest[triple[2]]];
    if (DoubledArea(a, b, c) != 0) return PlaneThrough(a, b, c);
  }
  return kNoPlane;
}

}  // namespace

std::vector<Plane> MakePlanarPrior(const Camera& camera,
                                   const std::vector<CrediblePoint>& points,
                                   const PriorRange& range,
                                   OutsideTriangles outside) {
  const size_t size = static_cast<size_t>(camera.width) * camera.height;
  std::vector<Plane> planes(size, kNoPlane);
  std::vector<bool> covered(size, false);
  for (const std::array<int, 3>& t :
       Triangulate(points, camera.width, camera.height)) {
    FillTriangle(camera,
                 {&points[t[0]], &points[t[1]], &points[t[2]]},
                 range,
                 &planes,
                 &covered);
  }
  if (outside == OutsideTriangles::kNothing || points.size() < kNumNearest)
    return planes;

  std::vector<float> queries;
  std::vector<size_t> query_pixels;
  for (size_t i = 0; i < size; ++i) {
    if (covered[i]) continue;
    query_pixels.push_back(i);
    const size_t col = i % camera.width, row = i / camera.width;
    queries.push_back(static_cast<float>(col));
    queries.push_back(static_cast<float>(row));
  }
  if (query_pixels.empty()) return planes;
  const std::vector<int> nearest = NearestPoints(points).Find(queries);
  for (size_t q = 0; q < query_pixels.size(); ++q) {
    const Plane plane = NearestPlane(points, &nearest[q * kNumNearest]);
    const size_t i = query_pixels[q];
    if (plane.distance > 0 && IsInRange(camera,
                                        plane,
                                        static_cast<int>(i % camera.width),
                                        static_cast<int>(i / camera.width),
                                        range)) {
      planes[i] = plane;
    }
  }
  return planes;
}

}  // namespace hpm
