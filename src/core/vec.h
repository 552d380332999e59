// 3-vectors and 3x3 matrices.
#pragma once

#include "src/core/host_device.h"

#include <math.h>

namespace hpm {

struct Vec3f {
  float x, y, z;
};

// Row-major.
struct Mat3f {
  float m[9];
};

HPM_HD Vec3f operator+(const Vec3f& a, const Vec3f& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HPM_HD Vec3f operator-(const Vec3f& a, const Vec3f& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HPM_HD Vec3f operator*(float s, const Vec3f& a) {
  return {s * a.x, s * a.y, s * a.z};
}
HPM_HD Vec3f operator-(const Vec3f& a) { return {-a.x, -a.y, -a.z}; }
HPM_HD float Dot(const Vec3f& a, const Vec3f& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HPM_HD Vec3f Cross(const Vec3f& a, const Vec3f& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HPM_HD float Norm(const Vec3f& a) { return sqrtf(Dot(a, a)); }
HPM_HD Vec3f Normalized(const Vec3f& a) { return (1.0f / Norm(a)) * a; }

HPM_HD Vec3f operator*(const Mat3f& a, const Vec3f& v) {
  return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z,
          a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
          a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
}
HPM_HD Mat3f operator*(const Mat3f& a, const Mat3f& b) {
  Mat3f c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      c.m[3 * i + j] = a.m[3 * i] * b.m[j] + a.m[3 * i + 1] * b.m[3 + j] +
                       a.m[3 * i + 2] * b.m[6 + j];
    }
  }
  return c;
}
HPM_HD Mat3f Transposed(const Mat3f& a) {
  return {
      {a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}

// As fminf and fmaxf for numbers, without their care for NaN and their call.
HPM_HD float Smaller(float a, float b) { return a < b ? a : b; }
HPM_HD float Larger(float a, float b) { return a > b ? a : b; }
HPM_HD float Clamp(float v, float lo, float hi) {
  return v < lo ? lo : (v > hi ? hi : v);
}

}  // namespace hpm
