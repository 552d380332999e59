// Surfaces with closed-form ray intersection, world frame.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace hpm {

// All points p with normal . (p - point) = 0, and border . (p - point) <= 0 if
// a border is given (a half-plane that ends at `point`).
struct PlaneSurface {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
  std::optional<Eigen::Vector3d> border;
};

struct SphereSurface {
  Eigen::Vector3d center;
  double radius;
};

using Surface = std::variant<PlaneSurface, SphereSurface>;

struct Hit {
  double t;  // point = origin + t * direction
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  // unit, against the ray
};

// Nearest hit with t > 0.
std::optional<Hit> Intersect(const std::vector<Surface>& surfaces,
                             const Eigen::Vector3d& origin,
                             const Eigen::Vector3d& direction);

}  // namespace hpm
