// Planar prior in the decision (ACMP's probabilistic form; specification 7.6):
// posterior = exp(-cost^2 / beta) * (gamma + depth likeness * normal likeness).
#pragma once

#include "src/core/plane.h"

#include <math.h>

namespace hpm {

struct PriorTerm {
  float gamma;        // 0.5
  float beta;         // 0.18
  float sigma_depth;  // model units
  float sigma_angle;  // radians
};

HPM_HD float AngleBetween(const Vec3f& a, const Vec3f& b) {
  return acosf(Clamp(Dot(a, b), -1.0f, 1.0f));
}

// Logarithm of the posterior (to be maximised); the logarithm keeps high costs
// apart where the product would underflow.
HPM_HD float LogPosterior(const PriorTerm& term,
                          float cost,
                          float depth,
                          const Vec3f& normal,
                          float prior_depth,
                          const Vec3f& prior_normal) {
  const float dz = (depth - prior_depth) / term.sigma_depth;
  const float da = AngleBetween(normal, prior_normal) / term.sigma_angle;
  const float likeness = expf(-0.5f * (dz * dz + da * da));
  return logf(term.gamma + likeness) - cost * cost / term.beta;
}

}  // namespace hpm
