// What one image in flight takes on a card.
#pragma once

#include "src/gpu/samplers.h"

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

// Once per card, for the stacks of the threads its processors can hold.
uint64_t DeviceOverheadBytes(int num_processors);

// Images in flight that fit into `free_bytes` beside the overhead, 0..most.
int ImagesThatFit(const ProblemSize& size,
                  ImageFormat format,
                  uint64_t free_bytes,
                  int num_processors,
                  int most);

}  // namespace hpm
