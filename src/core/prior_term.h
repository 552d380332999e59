// Planar prior in the decision (paper, section 3.3; ACMP's probabilistic form):
// posterior = exp(-cost^2 / beta) * (gamma + depth likeness * normal likeness).
#pragma once

#include "src/core/plane.h"

#include <math.h>

namespace hpm {

// Costs below it make a hypothesis credible (paper, section 3.3).
constexpr float kCredibleCost = 0.1f;

struct PriorTerm {
  float gamma;        // 0.5
  float beta;         // 0.18
  float sigma_depth;  // model units
  float sigma_angle;  // radians
};

HPM_HD float AngleBetween(const Vec3f& a, const Vec3f& b) {
  return acosf(Clamp(Dot(a, b), -1.0f, 1.0f));
}

// What nearness to the prior is worth, in units of squared cost: the order of
// the posteriors is the order of bonus - cost^2.
HPM_HD float PriorBonus(const PriorTerm& term,
                        float depth,
                        const Vec3f& normal,
                        float prior_depth,
                        const Vec3f& prior_normal) {
  const float dz = (depth - prior_depth) / term.sigma_depth;
  const float da = AngleBetween(normal, prior_normal) / term.sigma_angle;
  const float likeness = expf(-0.5f * (dz * dz + da * da));
  return term.beta * logf(term.gamma + likeness);
}

}  // namespace hpm
