// What one image in flight takes on the card.
#pragma once

#include "cuda/samplers.h"

#include <cstdint>

namespace hpm {

struct ProblemSize {
  int width, height;          // of the reference
  int src_width, src_height;  // largest of all sources
  int num_srcs;
  bool geometric;  // with depth maps of the sources
};

// Upper estimate in bytes.
uint64_t DeviceBytesNeeded(const ProblemSize& size, ImageFormat format);

// Images in flight that fit into `free_bytes`, 0..most.
int ImagesThatFit(const ProblemSize& size,
                  ImageFormat format,
                  uint64_t free_bytes,
                  int most);

}  // namespace hpm
