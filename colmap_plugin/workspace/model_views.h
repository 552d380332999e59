// The images as views of the model's world, in double: what a world point is in
// a view, and back. Models may lie far from their origin, where float32 is too
// coarse.
#pragma once

#include "colmap_plugin/workspace/workspace.h"

#include <optional>
#include <vector>

namespace hpm {

class ModelViews {
 public:
  explicit ModelViews(const Workspace& workspace);

  int size() const { return static_cast<int>(views_.size()); }
  // Views of unusable images see nothing and are seen by none.
  bool usable(int image) const { return views_[image].usable; }
  const Eigen::Vector3d& center(int image) const {
    return views_[image].center;
  }

  struct Projection {
    double x, y;   // parts of the image's width and height, 0 ... 1
    double depth;  // > 0
  };
  // Nothing if the point is behind the camera or beside the image.
  std::optional<Projection> Project(int image,
                                    const Eigen::Vector3d& point) const;

  // The inverse.
  Eigen::Vector3d PointAt(int image, const Projection& projection) const;

  // Points under a regular grid of 5 x 5 pixels at a depth.
  std::vector<Eigen::Vector3d> GridAt(int image, double depth) const;

 private:
  struct View {
    bool usable = false;
    Eigen::Matrix3d rotation;  // cam_from_world
    Eigen::Vector3d center;
    // Image coordinates as parts of the size: x = fx X / Z + cx.
    double fx = 1, fy = 1, cx = 0, cy = 0;
  };
  std::vector<View> views_;
};

// Below this angle between its rays from two views a depth is uncertain by more
// than it is worth: it is at the edge of what the filter takes away. Radians.
constexpr double kMinParallax = 2 * 3.14159265358979323846 / 180;

// How much two views help each other where their rays meet under this angle, 0
// ... 1: too small, and depth is uncertain; too large, and the images differ.
double ParallaxWeight(double angle);

// Radians, 0 ... pi, between the rays from the point to the two places; 0 if it
// is one of them.
double AngleAt(const Eigen::Vector3d& point,
               const Eigen::Vector3d& a,
               const Eigen::Vector3d& b);

}  // namespace hpm
