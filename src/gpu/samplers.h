// How a source image is read between its pixels. Integer positions are pixel
// centres; positions beyond the border get the border's value.
#pragma once

#include "src/gpu/device_instructions.h"
#include "src/gpu/device_problem.h"

namespace hpm {

// The formats in which the card holds the source images.
enum class ImageFormat {
  kByte,  // 8-bit texture, the card interpolates with 8-bit fractions
  kQuad,  // 32-bit words of four neighbours in plain memory, float fractions
};

// Exact bilinear interpolation in arithmetic units.
struct QuadSampler {
  HPM_HD_MEMBER explicit QuadSampler(const DeviceProblem&) {}

  HPM_HD_MEMBER float operator()(const ViewGeometry& view,
                                 int,
                                 float u,
                                 float v) const {
    float fu, fv;
    const int iu = SplitPosition(Clamp(u, 0.0f, view.max_u), &fu);
    const int iv = SplitPosition(Clamp(v, 0.0f, view.max_v), &fv);
    const uint32_t texel =
        view.texels[static_cast<size_t>(iv) * view.width + iu];
    const float p00 = ByteOf(texel, 0), p01 = ByteOf(texel, 1);
    const float p10 = ByteOf(texel, 2), p11 = ByteOf(texel, 3);
    const float top = p00 + fu * (p01 - p00);
    const float bottom = p10 + fu * (p11 - p10);
    return top + fv * (bottom - top);
  }
};

// The texture unit; on the host its arithmetic as the CUDA C++ Programming
// Guide states it ("Linear Filtering"): fractions have eight bits.
struct TextureSampler {
  HPM_HD_MEMBER explicit TextureSampler(const DeviceProblem& problem)
      : texture(problem.texture) {}

  HPM_HD_MEMBER float operator()(const ViewGeometry& view,
                                 int layer,
                                 float u,
                                 float v) const {
#if defined(HPM_DEVICE_PASS)
    (void)view;
    return 255 * FilteredTexel(texture, u + 0.5f, v + 0.5f, layer);
#else
    (void)layer;
    float fu, fv;
    const int iu = SplitPosition(Clamp(u, 0.0f, view.max_u), &fu);
    const int iv = SplitPosition(Clamp(v, 0.0f, view.max_v), &fv);
    fu = floorf(256 * fu + 0.5f) / 256;
    fv = floorf(256 * fv + 0.5f) / 256;
    const uint32_t texel =
        view.texels[static_cast<size_t>(iv) * view.width + iu];
    const float p00 = ByteOf(texel, 0), p01 = ByteOf(texel, 1);
    const float p10 = ByteOf(texel, 2), p11 = ByteOf(texel, 3);
    return (1 - fu) * (1 - fv) * p00 + fu * (1 - fv) * p01 +
           (1 - fu) * fv * p10 + fu * fv * p11;
#endif
  }

  unsigned long long texture;
};

}  // namespace hpm
