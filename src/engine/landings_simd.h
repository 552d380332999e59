// Where the pixels of a source lie in the reference, one to a SIMD lane: the
// inner loop of src/engine/view_propagation.h. The same bytes with all of
// Highway's targets: no lane meets another one, and nothing is fused.
#pragma once

#include "src/core/plane.h"
#include "src/core/warp.h"

#include <cstdint>

namespace hpm {

constexpr int kReach = 2;           // pixels, of a slope's differences
constexpr float kMaxBend = 0.01f;   // of 1/z over the reach, relative
constexpr float kMaxSlope = 0.05f;  // of 1/z per pixel, relative
constexpr float kMinFacing = 0.1f;  // cosine between normal and ray
constexpr int kMaxLandingLanes = 16;

// How a source lies to the reference.
struct SourcePose {
  Camera ref, src;
  ViewWarp to_ref;
  Mat3f rotation;      // from the source's frame to the reference's
  Vec3f ref_center;    // in the source's frame
  float z_min, z_max;  // what planes may have in the reference
};

// 1/z of a pixel of the source and of those kReach away, or of a row of them.
template <class T>
struct Surroundings {
  T here, left, right, above, below;
};

// The plane of a pixel of the source, from the slope of 1/z around it, in the
// reference's frame; distance 0 where the surface bends or is seen edge on.
Plane PlaneOfSource(const SourcePose& pose,
                    const Surroundings<float>& inverse_depth,
                    int col,
                    int row);

// A pixel of the source in the reference.
struct Landing {
  int32_t col, row;     // col < 0: nowhere
  float inverse_depth;  // 1/z of its plane on the ray of that pixel
};

// Of every step-th pixel of a row, num of them from column `col` on; so are the
// inverse depths. A pixel lands nowhere outside the image, where it has no
// plane, and where the reference allows it none. Reads and writes up to
// kMaxLandingLanes entries beyond.
void LandRow(const SourcePose& pose,
             const Surroundings<const float*>& inverse_depths,
             int col,
             int step,
             int row,
             int num,
             Landing* landings);

}  // namespace hpm
