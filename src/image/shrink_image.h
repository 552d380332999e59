// Images at reduced scale.
#pragma once

#include "src/image/gray_image.h"

namespace hpm {

// Mean of blocks of 2^level x 2^level pixels, rounded; partial blocks at the
// right and lower border count as pixels (the size of LevelCamera()).
GrayImage ShrinkImage(const GrayImage& image, int level);

}  // namespace hpm
