#include "src/engine/sweeps.h"

namespace hpm {

std::vector<Sweep> SweepsOf(const Pass& pass, uint64_t random_key) {
  const uint64_t pass_key = CombineBits(random_key, pass.id);
  Sweep sweep = {};
  sweep.geometric = pass.kind == PassKind::kGeometric;
  sweep.start = pass.start;
  std::vector<Sweep> sweeps;
  const auto add_colors_from = [&](int first) {
    for (sweep.color = first; sweep.color < 2; ++sweep.color) {
      sweeps.push_back(sweep);
    }
  };
  sweep.kind = SweepKind::kInitialize;
  sweep.key = CombineBits(pass_key, 0);
  if (pass.start != StartFrom::kStored) add_colors_from(0);
  for (int iteration = 0; iteration < pass.num_iterations; ++iteration) {
    sweep.kind = SweepKind::kUpdate;
    sweep.iteration = iteration;
    sweep.key = CombineBits(pass_key, 1 + iteration);
    add_colors_from(pass.first_color());
    if (!pass.half_visits) continue;
    sweep.kind = SweepKind::kFollow;
    sweep.color = 0;
    sweeps.push_back(sweep);
  }
  if (pass.median) {
    sweep.kind = SweepKind::kMedian;
    add_colors_from(0);
  }
  return sweeps;
}

std::vector<Sweep> ConsistencySweeps(const FilterParams& filter,
                                     bool geometric) {
  Sweep sweep = {};
  sweep.kind = SweepKind::kConsistency;
  sweep.filter = filter;
  sweep.geometric = geometric;
  std::vector<Sweep> sweeps(2, sweep);
  sweeps[1].color = 1;
  return sweeps;
}

}  // namespace hpm
