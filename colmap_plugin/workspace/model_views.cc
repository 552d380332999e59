#include "colmap_plugin/workspace/model_views.h"

#include "colmap_plugin/formats/model_pose.h"

#include <algorithm>
#include <cmath>

namespace hpm {

ModelViews::ModelViews(const Workspace& workspace) {
  for (int i = 0; i < workspace.num_images(); ++i) {
    View view;
    const SparseImage& image = workspace.model().images[i];
    const Camera& camera = workspace.camera(i);
    view.usable = workspace.usable(i);
    view.rotation = image.cam_from_world_rotation.toRotationMatrix();
    view.center = CenterOf(RigidPose{image.cam_from_world_rotation,
                                     image.cam_from_world_translation});
    if (view.usable) {
      // Integer coordinates are pixel centres there.
      view.fx = static_cast<double>(camera.fx) / camera.width;
      view.fy = static_cast<double>(camera.fy) / camera.height;
      view.cx = (static_cast<double>(camera.cx) + 0.5) / camera.width;
      view.cy = (static_cast<double>(camera.cy) + 0.5) / camera.height;
    }
    views_.push_back(view);
  }
}

std::optional<ModelViews::Projection> ModelViews::Project(
    int image, const Eigen::Vector3d& point) const {
  const View& view = views_[image];
  if (!view.usable) return std::nullopt;
  const Eigen::Vector3d in_camera = view.rotation * (point - view.center);
  const double depth = in_camera.z();
  if (!(depth > 0)) return std::nullopt;
  const Projection projection = {view.fx * in_camera.x() / depth + view.cx,
                                 view.fy * in_camera.y() / depth + view.cy,
                                 depth};
  if (!(projection.x >= 0 && projection.x < 1 && projection.y >= 0 &&
        projection.y < 1)) {
    return std::nullopt;
  }
  return projection;
}

Eigen::Vector3d ModelViews::PointAt(int image,
                                    const Projection& projection) const {
  const View& view = views_[image];
  const Eigen::Vector3d ray((projection.x - view.cx) / view.fx,
                            (projection.y - view.cy) / view.fy,
                            1);
  return view.rotation.transpose() * (projection.depth * ray) + view.center;
}

std::vector<Eigen::Vector3d> ModelViews::GridAt(int image, double depth) const {
  std::vector<Eigen::Vector3d> points;
  for (const double x : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    for (const double y : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      points.push_back(PointAt(image, {x, y, depth}));
    }
  }
  return points;
}

double ParallaxWeight(double angle) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  constexpr double kGood = 10 * kDegree;
  constexpr double kLarge = 30 * kDegree;
  constexpr double kTooLarge = 60 * kDegree;
  if (angle < kGood) return angle / kGood;
  if (angle < kLarge) return 1;
  return std::max(0.0, (kTooLarge - angle) / (kTooLarge - kLarge));
}

double AngleAt(const Eigen::Vector3d& point,
               const Eigen::Vector3d& a,
               const Eigen::Vector3d& b) {
  const Eigen::Vector3d to_a = a - point;
  const Eigen::Vector3d to_b = b - point;
  return std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b));
}

}  // namespace hpm
