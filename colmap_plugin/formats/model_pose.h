// Poses of a sparse model: from the numbers of a file, put together along rigs,
// and compared.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hpm {

// As the files hold a pose; nothing is checked.
struct PoseRecord {
  double rotation[4] = {1, 0, 0, 0};  // w, x, y, z
  double translation[3] = {0, 0, 0};
};

struct RigidPose {
  // Normalised; all NaN if the file's quaternion is zero or not finite.
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation;
};

RigidPose MakePose(const PoseRecord& record);

// c_from_b, b_from_a -> c_from_a.
RigidPose Composed(const RigidPose& c_from_b, const RigidPose& b_from_a);

// Where the camera stands in the world.
Eigen::Vector3d CenterOf(const RigidPose& cam_from_world);

// Radians, 0 ... pi; NaN if one of them is.
double AngleBetween(const RigidPose& a, const RigidPose& b);

}  // namespace hpm
