// A picture with texture to the left of a column and none to the right of it.
#pragma once

#include "src/engine/view.h"
#include "tests/engine/forward_camera.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace hpm {

// The view has a focal length of 40 pixels, looks along z from the origin and
// is its own only source; depths from 2 to 8 are allowed.
inline ViewSet HalfTextured(int width, int height, int edge) {
  GrayImage image = {
      width,
      height,
      std::vector<uint8_t>(static_cast<size_t>(width) * height, 100)};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < edge; ++col)
      image.data[row * width + col] =
          static_cast<uint8_t>(60 * (col / 2 % 3) + 40 * (row / 2 % 2));
  }
  ViewSet views;
  views.ref.camera = ForwardCamera(width, height, 0);
  views.ref.image = std::make_shared<const GrayImage>(std::move(image));
  views.srcs = {views.ref};
  views.depth_min = 2;
  views.depth_max = 8;
  views.random_key = 1;
  return views;
}

}  // namespace hpm
