#include "colmap_plugin/workspace/working_camera.h"

#include "colmap_plugin/formats/image_name.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace hpm {
namespace {

// Models that are a pinhole once their distortion parameters are zero. The
// parameters are f or fx, fy; cx, cy; then the distortion. Fisheye models are
// no pinhole even without distortion.
struct PerspectiveModel {
  const char* name;
  size_t num_focal_lengths;
  size_t num_params;
};
constexpr PerspectiveModel kPerspectiveModels[] = {
    {"SIMPLE_PINHOLE", 1, 3},
    {"PINHOLE", 2, 4},
    {"SIMPLE_RADIAL", 1, 4},
    {"RADIAL", 1, 5},
    {"OPENCV", 2, 8},
    {"FULL_OPENCV", 2, 12},
    {"FOV", 2, 5},
    {"SIMPLE_DIVISION", 1, 4},
    {"DIVISION", 2, 5},
};

// image_undistorter's own threshold for "nothing to undistort".
constexpr double kMaxDistortion = 1e-8;

struct Intrinsics {
  double fx, fy, cx, cy;  // pixels, of the sparse model
};

std::optional<Intrinsics> PinholeIntrinsics(const SparseCamera& camera,
                                            std::string* why_not) {
  const auto model = std::find_if(
      std::begin(kPerspectiveModels),
      std::end(kPerspectiveModels),
      [&](const PerspectiveModel& m) { return camera.model == m.name; });
  if (model == std::end(kPerspectiveModels)) {
    *why_not = fmt::format(
        "camera model {} is not a pinhole; undistort the images with "
        "image_undistorter",
        QuotedName(camera.model));
    return std::nullopt;
  }
  const std::vector<double>& params = camera.params;
  if (params.size() != model->num_params) {
    *why_not = fmt::format(
        "camera model {} has {} parameters, not {}; repair the sparse model",
        camera.model,
        params.size(),
        model->num_params);
    return std::nullopt;
  }
  for (size_t i = model->num_focal_lengths + 2; i < params.size(); ++i) {
    if (!(std::abs(params[i]) <= kMaxDistortion)) {
      *why_not = fmt::format(
          "camera model {} is distorted (parameter {} is {}); undistort the "
          "images with "
          "image_undistorter",
          camera.model,
          i + 1,
          params[i]);
      return std::nullopt;
    }
  }
  const size_t center = model->num_focal_lengths;
  return Intrinsics{
      params[0], params[center - 1], params[center], params[center + 1]};
}

bool IsPinhole(const Camera& camera) {
  const auto finite = [](float value) { return std::isfinite(value); };
  return camera.fx > 0 && camera.fy > 0 && finite(camera.fx) &&
         finite(camera.fy) && finite(camera.cx) && finite(camera.cy) &&
         std::all_of(camera.R.m, camera.R.m + 9, finite);
}

void LimitSize(int max_image_size, Camera* camera) {
  if (max_image_size <= 0) return;
  if (camera->width <= max_image_size && camera->height <= max_image_size)
    return;
  const float width = static_cast<float>(camera->width);
  const float height = static_cast<float>(camera->height);
  const float limit = static_cast<float>(max_image_size);
  const float factor = std::min(limit / width, limit / height);
  const float new_width = std::max(1.0f, std::round(width * factor));
  const float new_height = std::max(1.0f, std::round(height * factor));
  camera->fx *= new_width / width;
  camera->cx *= new_width / width;
  camera->fy *= new_height / height;
  camera->cy *= new_height / height;
  camera->width = static_cast<int>(new_width);
  camera->height = static_cast<int>(new_height);
}

}  // namespace

std::optional<Camera> MakeWorkingCamera(
    const SparseCamera& sparse_camera,
    const SparseImage& image,
    const std::optional<ImageSize>& file_size,
    int max_image_size,
    std::string* why_not) {
  std::optional<Intrinsics> intrinsics =
      PinholeIntrinsics(sparse_camera, why_not);
  if (!intrinsics) return std::nullopt;
  if (!IsImageSize(sparse_camera.width, sparse_camera.height)) {
    *why_not =
        fmt::format("camera size {}x{} is impossible; repair the sparse model",
                    sparse_camera.width,
                    sparse_camera.height);
    return std::nullopt;
  }
  ImageSize size{static_cast<int>(sparse_camera.width),
                 static_cast<int>(sparse_camera.height)};
  if (file_size) {
    const double scale_x = static_cast<double>(file_size->width) / size.width;
    const double scale_y = static_cast<double>(file_size->height) / size.height;
    intrinsics->fx *= scale_x;
    intrinsics->cx *= scale_x;
    intrinsics->fy *= scale_y;
    intrinsics->cy *= scale_y;
    size = *file_size;
  }

  const Eigen::Quaterniond& rotation = image.cam_from_world_rotation;
  const double norm = rotation.norm();
  if (!std::isfinite(norm) || norm == 0) {
    *why_not =
        "its rotation is not a number or zero; remove the image from the "
        "sparse model";
    return std::nullopt;
  }
  const Eigen::Matrix3f R =
      rotation.normalized().toRotationMatrix().cast<float>();

  Camera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = static_cast<float>(intrinsics->fx);
  camera.fy = static_cast<float>(intrinsics->fy);
  camera.cx = static_cast<float>(intrinsics->cx);
  camera.cy = static_cast<float>(intrinsics->cy);
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) camera.R.m[3 * row + col] = R(row, col);
  }
  camera.t = {0, 0, 0};
  LimitSize(max_image_size, &camera);
  if (!IsPinhole(camera) ||
      !image.cam_from_world_translation.cast<float>().allFinite()) {
    *why_not =
        "its pose, focal length or principal point is not a number or not "
        "positive; remove the "
        "image from the sparse model";
    return std::nullopt;
  }
  camera.cx -= 0.5f;
  camera.cy -= 0.5f;
  return camera;
}

}  // namespace hpm
