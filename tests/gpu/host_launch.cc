#include "tests/gpu/host_launch.h"

#include "src/gpu/lane_cost.h"
#include "src/gpu/texel_image.h"
#include "tests/gpu/core_cost.h"

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
  VisitPixel<kKind>({launch.problem.params,
                     launch.problem.pattern,
                     launch.sweep,
                     launch.state,
                     launch.problem.src_centers,
                     launch.consistent},
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

uint64_t RunBand(EmulatedCost cost,
                 const DeviceProblem& problem,
                 const Sweep& sweep,
                 const PixelState& state,
                 uint32_t* consistent,
                 const Band& band) {
  const Launch launch = {problem, sweep, state, consistent, band};
  switch (sweep.kind) {
    case SweepKind::kInitialize:
      return RunWith<SweepKind::kInitialize>(cost, launch);
    case SweepKind::kUpdate:
      return RunWith<SweepKind::kUpdate>(cost, launch);
    case SweepKind::kConsistency:
      return RunWith<SweepKind::kConsistency>(cost, launch);
    case SweepKind::kFollow:
    case SweepKind::kMedian:
      break;
  }
  ForEachPixel(band, [&](const Pixel& pixel) {
    VisitPixel(problem.params, sweep, state, pixel.col, pixel.row);
  });
  return 0;
}

float ScoreOnHost(EmulatedCost cost,
                  const DeviceProblem& problem,
                  const PixelPlane& at,
                  uint64_t* count) {
  float result = 0;
  *count += WithCost(cost, problem, at.col, at.row, [&](const auto& costs) {
    result = CostFromAllViews(problem.params, costs, at.plane);
  });
  return result;
}

std::vector<uint32_t> TexelsOf(const uint8_t* grey,
                               int row_length,
                               int width,
                               int height) {
  std::vector<uint8_t> image;
  for (int row = 0; row < height; ++row) {
    const uint8_t* begin = grey + static_cast<size_t>(row) * row_length;
    image.insert(image.end(), begin, begin + width);
  }
  std::vector<uint32_t> texels;
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col)
      texels.push_back(TexelAt(image.data(), width, height, col, row));
  }
  return texels;
}

}  // namespace hpm
