#include "tests/gpu/emulated_backend.h"

#include "src/gpu/upsampled_prior.h"

#include <algorithm>

namespace hpm {

void EmulatedBackend::SetViews(const ViewSet& views,
                               const MethodParams& params) {
  views_ = views;
  tables_ = MakeProblemTables(views, params);
  texels_.clear();
  num_evaluations_ = 0;
  for (size_t j = 0; j < views.srcs.size(); ++j) {
    const GrayImage& image = *views_.srcs[j].image;
    texels_.push_back(
        TexelsOf(image.data.data(), image.width, image.width, image.height));
    tables_.views[j].texels = texels_.back().data();
    if (views_.srcs[j].inverse_depth) {
      tables_.depth_views[j].inverse_depths =
          views_.srcs[j].inverse_depth->View();
    }
  }
  DeviceProblem& problem = tables_.problem;
  problem.ref_grey = views_.ref.image->data.data();
  problem.color_weights = tables_.color_weights.data();
  problem.views = tables_.views.data();
  problem.depth_views = tables_.depth_views.data();
  problem.src_centers = tables_.src_centers.data();
}

void EmulatedBackend::RunSweep(const Sweep& sweep,
                               const PixelState& state,
                               uint32_t* consistent) {
  tables_.problem.params.geometric = sweep.geometric;
  for (int first = 0; first < state.height; first += options_.rows_per_band) {
    num_evaluations_ +=
        RunBand(options_.cost,
                tables_.problem,
                sweep,
                state,
                consistent,
                {state.width,
                 state.height,
                 first,
                 std::min(options_.rows_per_band, state.height - first),
                 sweep.color,
                 options_.log_tile_width});
  }
}

void EmulatedBackend::Run(const Pass& pass,
                          const SamplingPattern& pattern,
                          HypothesisMap* map,
                          const RunControl& control) {
  SetPass(pass, pattern, &tables_);
  PixelState state = map->View();
  std::vector<Plane> priors;
  if (map->prior_level > 0) {
    for (int row = 0; row < map->height; ++row) {
      for (int col = 0; col < map->width; ++col) {
        priors.push_back(UpsampledPriorAt(
            tables_.problem, map->priors.data(), map->prior_level, col, row));
      }
    }
    state.priors = priors.data();
  }
  for (const Sweep& sweep : SweepsOf(pass, views_.random_key)) {
    control.cancel->ThrowIfCancelled();
    RunSweep(sweep, state, nullptr);
  }
  map->Touch();
}

std::vector<uint32_t> EmulatedBackend::ConsistentViews(
    const HypothesisMap& map,
    const FilterParams& filter,
    bool geometric,
    const RunControl&) {
  HypothesisMap copy = map;
  std::vector<uint32_t> consistent(map.planes.size());
  for (const Sweep& sweep : ConsistencySweeps(filter, geometric)) {
    RunSweep(sweep, copy.View(), consistent.data());
  }
  return consistent;
}

std::vector<float> EmulatedBackend::Score(const std::vector<PixelPlane>& planes,
                                          const RunControl&) {
  std::vector<float> costs;
  for (const PixelPlane& at : planes) {
    costs.push_back(
        ScoreOnHost(options_.cost, tables_.problem, at, &num_evaluations_));
  }
  return costs;
}

}  // namespace hpm
