// The few operations for which a card has an instruction of its own, and the
// same in C++ for the host. All that the code for cards owes to one vendor's
// compiler stands here: another kind of card adds its branch.
#pragma once

#include "src/core/host_device.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

// This pass of the compiler makes code for a card.
#if defined(__CUDA_ARCH__)
#define HPM_DEVICE_PASS
#endif

namespace hpm {

#if defined(HPM_DEVICE_PASS)
// A look-up of the texture unit; the centre of pixel 0 is at 0.5.
__device__ inline float FilteredTexel(unsigned long long texture,
                                      float u,
                                      float v,
                                      int layer) {
  return tex2DLayered<float>(texture, u, v, layer);
}
#endif

// 1 / x, up to the last digit; infinite where |x| < 2^-126.
HPM_HD float FastReciprocal(float x) {
#if defined(HPM_DEVICE_PASS)
  float result;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(result) : "f"(x));
  return result;
#else
  return 1.0f / x;
#endif
}

// 1 / sqrt(x), up to the last digits.
HPM_HD float FastInverseSqrt(float x) {
#if defined(HPM_DEVICE_PASS)
  return rsqrtf(x);
#else
  return 1.0f / sqrtf(x);
#endif
}

// Splits 0 <= x < 2^22 into integer and fraction. Conversions run at a quarter
// of the rate of additions; adding 2^23 with rounding down leaves the integer
// in the low bits.
HPM_HD int SplitPosition(float x, float* fraction) {
#if defined(HPM_DEVICE_PASS)
  const float shifted = __fadd_rd(x, 8388608.0f);
  *fraction = x - (shifted - 8388608.0f);
  return __float_as_int(shifted) & 0x7FFFFF;
#else
  const float whole = floorf(x);
  *fraction = x - whole;
  return static_cast<int>(whole);
#endif
}

// Byte `index` of a texel as a float, without a conversion: the byte becomes
// the low bits of 2^23.
HPM_HD float ByteOf(uint32_t texel, int index) {
#if defined(HPM_DEVICE_PASS)
  return __uint_as_float(__byte_perm(texel, 0x4B000000u, 0x7650 + index)) -
         8388608.0f;
#else
  return static_cast<float>(texel >> (8 * index) & 255);
#endif
}

}  // namespace hpm
