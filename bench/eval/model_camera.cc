#include "bench/eval/model_camera.h"

#include "src/base/error.h"

namespace hpm {

Camera ModelCamera(const SparseModel& model,
                   const SparseImage& image,
                   int width,
                   int height) {
  const auto it = model.cameras.find(image.camera_id);
  if (it == model.cameras.end()) {
    throw Error(ErrorCode::kBadInput,
                image.name + ": its camera is missing in the model");
  }
  const SparseCamera& camera = it->second;
  const std::vector<double>& p = camera.params;
  double fx, fy, cx, cy;
  if (camera.model == "PINHOLE" && p.size() == 4) {
    fx = p[0], fy = p[1], cx = p[2], cy = p[3];
  } else if (camera.model == "SIMPLE_PINHOLE" && p.size() == 3) {
    fx = fy = p[0], cx = p[1], cy = p[2];
  } else {
    throw Error(
        ErrorCode::kBadInput,
        image.name + ": camera model " + camera.model + " is not a pinhole");
  }
  const double scale_x =
      static_cast<double>(width) / static_cast<double>(camera.width);
  const double scale_y =
      static_cast<double>(height) / static_cast<double>(camera.height);
  Camera result;
  result.width = width;
  result.height = height;
  result.fx = static_cast<float>(scale_x * fx);
  result.fy = static_cast<float>(scale_y * fy);
  result.cx = static_cast<float>(scale_x * cx);
  result.cy = static_cast<float>(scale_y * cy);
  const Eigen::Matrix3d rotation =
      image.cam_from_world_rotation.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      result.R.m[3 * i + j] = static_cast<float>(rotation(i, j));
  }
  const Eigen::Vector3f t = image.cam_from_world_translation.cast<float>();
  result.t = {t.x(), t.y(), t.z()};
  return result;
}

}  // namespace hpm
