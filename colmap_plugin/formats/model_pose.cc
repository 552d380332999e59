#include "colmap_plugin/formats/model_pose.h"

#include <cmath>
#include <limits>

namespace hpm {
namespace {

// Scaled by the largest part first: squares of finite values may overflow or
// vanish.
Eigen::Quaterniond Normalized(const double wxyz[4]) {
  Eigen::Vector4d q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const double scale = q.cwiseAbs().maxCoeff();
  if (!q.allFinite() || scale == 0) {
    q.setConstant(std::numeric_limits<double>::quiet_NaN());
  } else {
    q /= scale;
    q /= q.norm();
  }
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
}

}  // namespace

RigidPose MakePose(const PoseRecord& record) {
  return {
      Normalized(record.rotation),
      Eigen::Vector3d(
          record.translation[0], record.translation[1], record.translation[2])};
}

RigidPose Composed(const RigidPose& c_from_b, const RigidPose& b_from_a) {
  // Not normalised again: unit quaternions stay so, and the identity changes no
  // digit.
  return {c_from_b.rotation * b_from_a.rotation,
          c_from_b.rotation * b_from_a.translation + c_from_b.translation};
}

Eigen::Vector3d CenterOf(const RigidPose& cam_from_world) {
  return cam_from_world.rotation.conjugate() * -cam_from_world.translation;
}

double AngleBetween(const RigidPose& a, const RigidPose& b) {
  const Eigen::Quaterniond turn = a.rotation.conjugate() * b.rotation;
  return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

}  // namespace hpm
