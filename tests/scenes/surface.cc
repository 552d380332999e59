#include "tests/scenes/surface.h"

#include <cmath>

#include <Eigen/Geometry>

namespace hpm {
namespace {

using Eigen::Vector3d;

std::optional<double> Distance(const PlaneSurface& plane,
                               const Vector3d& origin,
                               const Vector3d& direction) {
  const double slope = plane.normal.dot(direction);
  if (slope == 0) return std::nullopt;
  const double t = plane.normal.dot(plane.point - origin) / slope;
  if (plane.border &&
      plane.border->dot(origin + t * direction - plane.point) > 0) {
    return std::nullopt;
  }
  return t;
}

// The near side only: cameras stay outside of spheres.
std::optional<double> Distance(const SphereSurface& sphere,
                               const Vector3d& origin,
                               const Vector3d& direction) {
  const Vector3d offset = origin - sphere.center;
  const double a = direction.squaredNorm();
  const double b = offset.dot(direction);
  const double c = offset.squaredNorm() - sphere.radius * sphere.radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return std::nullopt;
  return (-b - std::sqrt(discriminant)) / a;
}

Vector3d NormalAt(const PlaneSurface& plane, const Vector3d&) {
  return plane.normal.normalized();
}

Vector3d NormalAt(const SphereSurface& sphere, const Vector3d& point) {
  return (point - sphere.center).normalized();
}

}  // namespace

std::optional<Hit> Intersect(const std::vector<Surface>& surfaces,
                             const Vector3d& origin,
                             const Vector3d& direction) {
  const Surface* nearest = nullptr;
  double nearest_t = 0;
  for (const Surface& surface : surfaces) {
    const auto t = std::visit(
        [&](const auto& shape) { return Distance(shape, origin, direction); },
        surface);
    if (!t || *t <= 0 || (nearest != nullptr && *t >= nearest_t)) continue;
    nearest = &surface;
    nearest_t = *t;
  }
  if (nearest == nullptr) return std::nullopt;
  const Vector3d point = origin + nearest_t * direction;
  Vector3d normal = std::visit(
      [&](const auto& shape) { return NormalAt(shape, point); }, *nearest);
  if (normal.dot(direction) > 0) normal = -normal;
  return Hit{nearest_t, point, normal};
}

}  // namespace hpm
