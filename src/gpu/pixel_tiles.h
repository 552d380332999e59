// Which pixel a lane visits. The lanes that a card runs together (a warp, a
// wave) take the pixels of one colour in a tile of 2^log_width x 2 lanes /
// 2^log_width pixels, so that neighbours in the image are neighbours among the
// lanes.
#pragma once

#include "src/core/host_device.h"

#include <stdint.h>

namespace hpm {

// A band of rows of a half-sweep: one launch. kNumLanes: of a warp.
template <int kNumLanes>
struct TileBand {
  static constexpr int kTilePixels = 2 * kNumLanes;  // of both colours

  int width, height;  // of the image
  int first_row, num_rows;
  int color;
  int log_width;  // of a tile; 2..kTilePixels pixels

  HPM_HD_MEMBER int tile_width() const { return 1 << log_width; }
  HPM_HD_MEMBER int tile_height() const { return kTilePixels >> log_width; }
  HPM_HD_MEMBER int tiles_per_row() const {
    return (width + tile_width() - 1) >> log_width;
  }
  HPM_HD_MEMBER int64_t num_warps() const {
    return static_cast<int64_t>(tiles_per_row()) *
           ((num_rows + tile_height() - 1) / tile_height());
  }
};

struct Pixel {
  int col, row;
  bool inside;  // of the band and the image
};

template <int kNumLanes>
HPM_HD Pixel PixelOf(const TileBand<kNumLanes>& band, int64_t warp, int lane) {
  const int tile_row = static_cast<int>(warp / band.tiles_per_row());
  const int tile_col = static_cast<int>(warp % band.tiles_per_row());
  const int pairs = band.tile_width() / 2;  // pixels of one colour per row
  const int local_row = lane / pairs;
  const int row = band.first_row + tile_row * band.tile_height() + local_row;
  const int col = tile_col * band.tile_width() + 2 * (lane % pairs) +
                  ((row + band.color) & 1);
  return {col,
          row,
          col < band.width && row < band.height &&
              row < band.first_row + band.num_rows};
}

}  // namespace hpm
