// Connected regions of the reference image without texture: there a matching
// cost says little, and one surface usually fills the region.
#pragma once

#include "src/image/gray_image.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace hpm {

// Rows [begin, end) of an image.
struct Rows {
  int begin, end;
};

struct WeakRegions {
  int width = 0, height = 0;
  int num_regions = 0;
  std::vector<uint16_t> label;  // row-major, 0 = textured, regions from 1

  int At(int col, int row) const {
    return label[static_cast<size_t>(row) * width + col];
  }

  // Whether the pixel's region fills the window of `radius` around it, as far
  // as that lies in the image.
  bool Fills(int col, int row, int radius) const {
    const int own = At(col, row);
    for (int r = std::max(0, row - radius);
         r <= std::min(height - 1, row + radius);
         ++r) {
      for (int c = std::max(0, col - radius);
           c <= std::min(width - 1, col + radius);
           ++c) {
        if (At(c, r) != own) return false;
      }
    }
    return true;
  }

  // Calls visit(rows) for bands that make up the image, from several threads.
  // Each begins at a multiple of 64 rows, so that no two share a word of a
  // std::vector<bool>.
  void ForEachBand(const std::function<void(const Rows&)>& visit) const;

  // Calls visit(label) for the weak pixels at most `radius` away.
  template <class Visit>
  void ForEachNear(int col, int row, int radius, const Visit& visit) const {
    for (int r = std::max(0, row - radius);
         r <= std::min(height - 1, row + radius);
         ++r) {
      for (int c = std::max(0, col - radius);
           c <= std::min(width - 1, col + radius);
           ++c) {
        if (At(c, r) > 0) visit(At(c, r));
      }
    }
  }
};

// The least and the greatest label in the window of `radius` around each pixel
// of some rows, as far as that lies in the image.
class LabelWindows {
 public:
  LabelWindows(const WeakRegions& regions, const Rows& rows, int radius);

  // At a pixel of the image, in these rows.
  int Least(int col, int row) const { return least_[At(col, row)]; }
  int Greatest(int col, int row) const { return greatest_[At(col, row)]; }

 private:
  size_t At(int col, int row) const {
    return static_cast<size_t>(row - first_row_) * width_ + col;
  }

  int first_row_;  // of those that are held
  int width_;
  std::vector<uint16_t> least_, greatest_;
};

// Pixels whose gradient, after a slight blur against noise, stays under
// `max_gradient` (grey levels per pixel) and that belong to a 4-connected
// region of at least `min_share` of the image.
WeakRegions FindWeakRegions(const GrayImage& image,
                            float max_gradient,
                            float min_share);

}  // namespace hpm
