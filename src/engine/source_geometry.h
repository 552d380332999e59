// How a source lies to the reference of its problem; CPU, CUDA, priors and the
// filter of finished maps all go by it.
#pragma once

#include "src/core/geometric_term.h"
#include "src/engine/view.h"

namespace hpm {

// In both directions, with the source's depth if it has any.
inline DepthView DepthViewOf(const Camera& ref, const View& src) {
  return {MakeViewWarp(ref, src.camera),
          MakeViewWarp(src.camera, ref),
          src.inverse_depth != nullptr ? src.inverse_depth->View()
                                       : InverseDepths{nullptr, 0}};
}

// The source's centre in the camera frame of the reference, model units.
inline Vec3f CenterOf(const Camera& ref, const View& src) {
  return CamFromWorld(ref, Center(src.camera));
}

}  // namespace hpm
