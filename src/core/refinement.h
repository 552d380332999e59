// New hypotheses around the current one (paper, section 3.2, equation of the
// seven hypotheses: combinations of current, perturbed and random depth and
// normal).
#pragma once

#include "src/core/plane.h"
#include "src/core/rng.h"

#include <math.h>

namespace hpm {

constexpr int kNumCombined = 3;
constexpr int kNumRefined = 2 * kNumCombined;

// Uniform on the hemisphere that faces the camera along `ray`.
HPM_HD Vec3f RandomNormal(const Vec3f& ray, Rng* rng) {
  const float z = rng->Uniform(-1.0f, 1.0f);
  const float phi = rng->Uniform(0.0f, 6.28318531f);
  const float s = sqrtf(Larger(0.0f, 1.0f - z * z));
  const Vec3f n = {s * cosf(phi), s * sinf(phi), z};
  return Dot(n, ray) > 0 ? -n : n;
}

// Rotates n by three independent angles in +-max_angle (radians) about x, y and
// z; keeps n if the result would face away.
HPM_HD Vec3f PerturbNormal(const Vec3f& n,
                           const Vec3f& ray,
                           float max_angle,
                           Rng* rng) {
  const float a = rng->Uniform(-max_angle, max_angle);
  const float b = rng->Uniform(-max_angle, max_angle);
  const float c = rng->Uniform(-max_angle, max_angle);
  const float sa = sinf(a), ca = cosf(a), sb = sinf(b), cb = cosf(b),
              sc = sinf(c), cc = cosf(c);
  const Vec3f x = {n.x, ca * n.y - sa * n.z, sa * n.y + ca * n.z};
  const Vec3f y = {cb * x.x + sb * x.z, x.y, -sb * x.x + cb * x.z};
  const Vec3f z = Normalized({cc * y.x - sc * y.y, sc * y.x + cc * y.y, y.z});
  return Dot(z, ray) < 0 ? z : n;
}

// The hypotheses beside the current one, from another depth and normal: random
// or perturbed ones.
HPM_HD void CombineHypotheses(const Vec3f& ray,
                              float z,
                              const Vec3f& n,
                              float z_other,
                              const Vec3f& n_other,
                              Plane planes[kNumCombined]) {
  planes[0] = PlaneOnRay(ray, z_other, n);
  planes[1] = PlaneOnRay(ray, z, n_other);
  planes[2] = PlaneOnRay(ray, z_other, n_other);
}

}  // namespace hpm
