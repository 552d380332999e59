// Whether a device computes what it should: a small scene with known depth,
// estimated before the first image. A card that passes launches but computes
// rubbish (wrong driver, no code for it, faulty memory) must not write maps.
#pragma once

#include "src/engine/backend.h"

#include <string>

namespace hpm {

// Empty if `backend` passes, else what was wrong. Takes milliseconds on a card.
// Leaves the test's views in the backend.
std::string SelfTestFailure(Backend* backend);

}  // namespace hpm
