#include "colmap_plugin/formats/camera_models.h"

#include <algorithm>
#include <iterator>

namespace hpm {
namespace {

constexpr CameraModelInfo kModels[] = {
    {0, "SIMPLE_PINHOLE", 3},
    {1, "PINHOLE", 4},
    {2, "SIMPLE_RADIAL", 4},
    {3, "RADIAL", 5},
    {4, "OPENCV", 8},
    {5, "OPENCV_FISHEYE", 8},
    {6, "FULL_OPENCV", 12},
    {7, "FOV", 5},
    {8, "SIMPLE_RADIAL_FISHEYE", 4},
    {9, "RADIAL_FISHEYE", 5},
    {10, "THIN_PRISM_FISHEYE", 12},
    {11, "RAD_TAN_THIN_PRISM_FISHEYE", 16},
    {12, "SIMPLE_DIVISION", 4},
    {13, "DIVISION", 5},
    {14, "SIMPLE_FISHEYE", 3},
    {15, "FISHEYE", 4},
    {16, "EUCM", 6},
    {17, "EQUIRECTANGULAR", 2},
};

template <class Predicate>
const CameraModelInfo* Find(Predicate predicate) {
  const auto it =
      std::find_if(std::begin(kModels), std::end(kModels), predicate);
  return it == std::end(kModels) ? nullptr : it;
}

}  // namespace

const CameraModelInfo* FindCameraModel(int id) {
  return Find([id](const CameraModelInfo& model) { return model.id == id; });
}

const CameraModelInfo* FindCameraModel(std::string_view name) {
  return Find(
      [name](const CameraModelInfo& model) { return model.name == name; });
}

}  // namespace hpm
