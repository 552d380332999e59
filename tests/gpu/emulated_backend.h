// The CUDA backend without a card: the same tables, sweeps, bands, tiles and
// visits as cuda/cuda_backend.cc, with loops in place of launches.
#pragma once

#include "src/engine/backend.h"
#include "src/engine/sweeps.h"
#include "src/gpu/problem_tables.h"
#include "tests/gpu/host_launch.h"

#include <memory>
#include <vector>

namespace hpm {

struct EmulationOptions {
  EmulatedCost cost = EmulatedCost::kCore;
  int log_tile_width = 3;
  int rows_per_band = 16;
};

class EmulatedBackend : public Backend {
 public:
  explicit EmulatedBackend(const EmulationOptions& options)
      : options_(options) {}

  std::string Name() const override { return "emulated"; }
  uint64_t MemoryNeeded(int, int, int) const override { return 0; }
  bool UpsamplesPriors() const override { return true; }
  void SetViews(const ViewSet& views, const MethodParams& params) override;
  void Run(const Pass& pass,
           const SamplingPattern& pattern,
           HypothesisMap* map,
           const RunControl& control) override;
  std::vector<uint32_t> ConsistentViews(const HypothesisMap& map,
                                        const FilterParams& filter,
                                        bool geometric,
                                        const RunControl& control) override;
  std::vector<float> Score(const std::vector<PixelPlane>& planes,
                           const RunControl& control) override;
  uint64_t num_cost_evaluations() const override { return num_evaluations_; }

  const DeviceProblem& problem() const { return tables_.problem; }

 private:
  void RunSweep(const Sweep& sweep,
                const PixelState& state,
                uint32_t* consistent);

  EmulationOptions options_;
  ViewSet views_;
  ProblemTables tables_;
  std::vector<std::vector<uint32_t>> texels_;
  uint64_t num_evaluations_ = 0;
};

}  // namespace hpm
