// Cameras and planes for tests, and projection in double precision, written
// without the code under test.
#pragma once

#include "src/core/plane.h"

#include <random>

#include <Eigen/Geometry>

namespace hpm {

using Random = std::mt19937;

// The standard distributions differ between libraries.
inline double UniformIn(Random* random, double lo, double hi) {
  return lo + (hi - lo) * ((*random)() / 4294967296.0);
}

// Near `center`, looks roughly along the world's +z, rolled by `roll` radians.
inline Camera MakeTestCamera(int width,
                             int height,
                             double focal,
                             double roll,
                             const Eigen::Vector3d& center,
                             const Eigen::Vector3d& tilt = {0, 0, 0}) {
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(tilt.x(), Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(tilt.y(), Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  const Eigen::Vector3d t = -rotation * center;
  Camera camera = {};
  camera.width = width;
  camera.height = height;
  camera.fx = static_cast<float>(focal);
  camera.fy = static_cast<float>(1.1 * focal);
  camera.cx = 0.48f * static_cast<float>(width);
  camera.cy = 0.53f * static_cast<float>(height);
  for (int k = 0; k < 9; ++k) {
    camera.R.m[k] = static_cast<float>(rotation(k / 3, k % 3));
  }
  camera.t = {static_cast<float>(t.x()),
              static_cast<float>(t.y()),
              static_cast<float>(t.z())};
  return camera;
}

// Any size, any roll, up to half a unit off the origin.
inline Camera RandomCamera(Random* random) {
  const int width = 100 + static_cast<int>((*random)() % 400);
  const int height = 80 + static_cast<int>((*random)() % 400);
  return MakeTestCamera(
      width,
      height,
      UniformIn(random, 0.8, 1.5) * width,
      UniformIn(random, -M_PI, M_PI),
      {UniformIn(random, -0.5, 0.5),
       UniformIn(random, -0.5, 0.5),
       UniformIn(random, -0.5, 0.5)},
      {UniformIn(random, -0.1, 0.1), UniformIn(random, -0.1, 0.1), 0});
}

// Unit, within some 60 degrees of facing the camera head-on.
inline Vec3f RandomFacingNormal(Random* random) {
  return Normalized({static_cast<float>(UniformIn(random, -1, 1)),
                     static_cast<float>(UniformIn(random, -1, 1)),
                     -1});
}

inline Eigen::Vector3d ToEigen(const Vec3f& v) { return {v.x, v.y, v.z}; }

inline Eigen::Matrix3d RotationOf(const Camera& camera) {
  return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
             camera.R.m)
      .cast<double>();
}

inline Eigen::Vector3d InWorld(const Camera& camera,
                               const Eigen::Vector3d& in_camera) {
  return RotationOf(camera).transpose() * (in_camera - ToEigen(camera.t));
}

inline Eigen::Vector3d InCamera(const Camera& camera,
                                const Eigen::Vector3d& in_world) {
  return RotationOf(camera) * in_world + ToEigen(camera.t);
}

// Pixel position and depth.
inline Eigen::Vector3d ProjectInto(const Camera& camera,
                                   const Eigen::Vector3d& in_world) {
  const Eigen::Vector3d p = InCamera(camera, in_world);
  return {camera.fx * p.x() / p.z() + camera.cx,
          camera.fy * p.y() / p.z() + camera.cy,
          p.z()};
}

// Where the ray of (col, row) meets the plane, camera frame.
inline Eigen::Vector3d PointOn(const Camera& camera,
                               const Plane& plane,
                               double col,
                               double row) {
  const Eigen::Vector3d ray(
      (col - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1);
  return -plane.distance / ToEigen(plane.normal).dot(ray) * ray;
}

}  // namespace hpm
