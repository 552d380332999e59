// What the CUDA backend throws: an Error that another device may not have.
#pragma once

#include "src/base/error.h"

namespace hpm {

// kOutOfResources: the card's memory is exhausted; kDevice: anything else.
class GpuError : public Error {
 public:
  using Error::Error;
};

}  // namespace hpm
