#include "tests/cuda/emulated_backend.h"

#include "cuda/lane_cost.h"
#include "cuda/pixel_tiles.h"
#include "cuda/texel_image.h"

#include <algorithm>

namespace hpm {
namespace {

struct Launch {
  const DeviceProblem& problem;
  const Sweep& sweep;
  const PixelState& state;
  uint32_t* consistent;
  Band band;
};

template <SweepKind kKind, class Cost>
void Visit(const Launch& launch, const Cost& cost, const Pixel& pixel) {
  VisitPixel<kKind>(launch.problem,
                    launch.sweep,
                    launch.state,
                    launch.consistent,
                    cost,
                    pixel.col,
                    pixel.row);
}

// Calls visit(pixel) for all pixels of the band, as the kernels would.
template <class VisitOne>
void ForEachPixel(const Band& band, const VisitOne& visit) {
  for (int64_t warp = 0; warp < band.num_warps(); ++warp) {
    for (int lane = 0; lane < kWarpSize; ++lane) {
      const Pixel pixel = PixelOf(band, warp, lane);
      if (pixel.inside) visit(pixel);
    }
  }
}

// Calls use(cost) with the Cost of a pixel; returns its evaluations.
template <class Use>
uint64_t WithCost(EmulatedCost kind,
                  const DeviceProblem& problem,
                  int col,
                  int row,
                  const Use& use) {
  const RefPatch patch = RefPatchAt(problem, col, row);
  WindowSample samples[kPatchSize];
  StoreWindow(patch, samples, 1);
  const Window window = {samples, 1, patch.center, patch.mean, patch.variance};
  const auto counted = [&](const auto& cost) {
    use(cost);
    return static_cast<uint64_t>(cost.num_evaluations());
  };
  switch (kind) {
    case EmulatedCost::kCore:
      return counted(CoreCost(problem, patch, col, row));
    case EmulatedCost::kQuad:
      return counted(LaneCost<QuadSampler>(problem, window, col, row));
    case EmulatedCost::kTexture:
      break;
  }
  return counted(LaneCost<TextureSampler>(problem, window, col, row));
}

template <SweepKind kKind>
uint64_t RunWith(EmulatedCost kind, const Launch& launch) {
  uint64_t evaluations = 0;
  ForEachPixel(launch.band, [&](const Pixel& pixel) {
    evaluations += WithCost(
        kind, launch.problem, pixel.col, pixel.row, [&](const auto& cost) {
          Visit<kKind>(launch, cost, pixel);
        });
  });
  return evaluations;
}

}  // namespace

void EmulatedBackend::SetViews(const ViewSet& views,
                               const MethodParams& params) {
  views_ = views;
  tables_ = MakeProblemTables(views, params);
  texels_.clear();
  num_evaluations_ = 0;
  for (size_t j = 0; j < views.srcs.size(); ++j) {
    const GrayImage& image = *views_.srcs[j].image;
    std::vector<uint32_t> texels;
    for (int row = 0; row < image.height; ++row) {
      for (int col = 0; col < image.width; ++col) {
        texels.push_back(
            TexelAt(image.data.data(), image.width, image.height, col, row));
      }
    }
    texels_.push_back(std::move(texels));
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
    const Launch launch = {
        tables_.problem,
        sweep,
        state,
        consistent,
        {state.width,
         state.height,
         first,
         std::min(options_.rows_per_band, state.height - first),
         sweep.color,
         options_.log_tile_width}};
    switch (sweep.kind) {
      case SweepKind::kInitialize:
        num_evaluations_ +=
            RunWith<SweepKind::kInitialize>(options_.cost, launch);
        break;
      case SweepKind::kUpdate:
        num_evaluations_ += RunWith<SweepKind::kUpdate>(options_.cost, launch);
        break;
      case SweepKind::kConsistency:
        num_evaluations_ +=
            RunWith<SweepKind::kConsistency>(options_.cost, launch);
        break;
      case SweepKind::kFollow:
        ForEachPixel(launch.band, [&](const Pixel& pixel) {
          TakeNeighbour(tables_.problem.params, state, pixel.col, pixel.row);
        });
        break;
      case SweepKind::kMedian:
        ForEachPixel(launch.band, [&](const Pixel& pixel) {
          MedianFilterPixel(
              tables_.problem.params.ref, state, pixel.col, pixel.row);
        });
        break;
    }
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
    num_evaluations_ += WithCost(
        options_.cost, tables_.problem, at.col, at.row, [&](const auto& cost) {
          costs.push_back(
              CostFromAllViews(tables_.problem.params, cost, at.plane));
        });
  }
  return costs;
}

}  // namespace hpm
