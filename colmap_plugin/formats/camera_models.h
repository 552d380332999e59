// COLMAP's camera models (releases up to 4.1 and the development head after
// it): id in binary files, name in text files, number of parameters.
#pragma once

#include <string_view>

namespace hpm {

struct CameraModelInfo {
  int id;
  std::string_view name;
  int num_params;
};

// nullptr for an unknown model.
const CameraModelInfo* FindCameraModel(int id);
const CameraModelInfo* FindCameraModel(std::string_view name);

}  // namespace hpm
