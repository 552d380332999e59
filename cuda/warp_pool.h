// The Cost of a pixel visit (see src/core/visit.h) in which the 32 visitors of
// a warp compute their pairs together.
//
// Alone, a lane that asks for many pairs keeps the others waiting: neighbours
// disagree about how many candidates differ, which regions grow and which views
// count. Here a request becomes entries of one list, ordered by view, plane,
// lane, and every 32 entries make one round in which all lanes work; a round
// mostly reads one source view around one place. A lane that is through its
// visit goes on serving until the whole warp is.
//
// `Warp` is the machine: lane(), Ballot(bool) over all 32 lanes, Sync(). On the
// host, tests bring one made of threads.
#pragma once

#include "cuda/pair_cost.h"
#include "cuda/pixel_cost.h"
#include "cuda/pixel_tiles.h"

#if defined(__CUDACC__)
#define HPM_NO_INLINE __noinline__
#else
#define HPM_NO_INLINE
#endif

namespace hpm {

HPM_HD int CountBits(uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return __popc(bits);
#else
  return __builtin_popcount(bits);
#endif
}

// In shared memory, one per warp.
struct WarpPool {
  static constexpr int kNumSlots = 512;
  static_assert(kNumSlots >= kNumRegions * kWarpSize,
                "one view of all requests must fit");
  union Slot {
    uint32_t pair;  // lane | plane << 5 | view << 8
    float cost;
  };

  WindowSample samples[kPatchSize][kWarpSize];
  float center[kWarpSize], mean[kWarpSize], variance[kWarpSize];
  float col[kWarpSize], row[kWarpSize];
  PlaneSlope slopes[kNumRegions][kWarpSize];
  Slot slots[kNumSlots];

  // Before the visit, by the lane itself.
  HPM_HD_MEMBER void SetPixel(int lane, const RefPatch& patch, int c, int r) {
    StoreWindow(patch, &samples[0][lane], kWarpSize);
    center[lane] = patch.center;
    mean[lane] = patch.mean;
    variance[lane] = patch.variance;
    col[lane] = static_cast<float>(c);
    row[lane] = static_cast<float>(r);
  }
};

// Gives each pair of one view its place in the list: calls visit(plane, place)
// for the pairs of `lane` and returns the place behind the view. wants: lanes
// that ask for the view; has_plane[i]: lanes with more than i planes.
template <class Visit>
HPM_HD int PlacePairs(uint32_t wants,
                      const uint32_t* has_plane,
                      int lane,
                      int place,
                      const Visit& visit) {
  const uint32_t lower_lanes = (1u << lane) - 1;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < kNumRegions; ++i) {
    const uint32_t lanes = wants & has_plane[i];
    if (lanes >> lane & 1) visit(i, place + CountBits(lanes & lower_lanes));
    place += CountBits(lanes);
  }
  return place;
}

// All lanes of the warp call this together, each with its own request or none
// (num_planes = 0). Slopes of the planes stand in the pool. wanted: bit per
// view. costs[i * (number of wanted views) + rank of the view]. False if no
// lane asked.
template <class Sampler, class Warp>
HPM_HD_MEMBER HPM_NO_INLINE bool EvaluateTogether(const DeviceProblem& problem,
                                                  const Warp& warp,
                                                  WarpPool* pool,
                                                  int num_planes,
                                                  uint32_t wanted,
                                                  float* costs) {
  warp.Sync();
  if (warp.Ballot(num_planes > 0) == 0) return false;
  const int lane = warp.lane();
  uint32_t has_plane[kNumRegions];
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < kNumRegions; ++i) {
    has_plane[i] = warp.Ballot(num_planes > i);
  }
  const int num_views = problem.params.num_views;
  const int num_wanted = CountBits(wanted);
  const Sampler sampler(problem);
  for (int begin = 0; begin < num_views;) {
    int end = begin, filled = 0;
    for (; end < num_views; ++end) {
      const uint32_t wants = warp.Ballot(wanted >> end & 1);
      int size = 0;
      for (int i = 0; i < kNumRegions; ++i) {
        size += CountBits(wants & has_plane[i]);
      }
      if (filled + size > WarpPool::kNumSlots) break;
      filled =
          PlacePairs(wants, has_plane, lane, filled, [&](int plane, int place) {
            pool->slots[place].pair =
                static_cast<uint32_t>(lane | plane << 5 | end << 8);
          });
    }
    warp.Sync();
    for (int place = lane; place < filled; place += kWarpSize) {
      const uint32_t pair = pool->slots[place].pair;
      const int owner = static_cast<int>(pair & 31);
      const int plane = static_cast<int>(pair >> 5 & 7);
      const int view = static_cast<int>(pair >> 8);
      const Window window = {&pool->samples[0][owner],
                             kWarpSize,
                             pool->center[owner],
                             pool->mean[owner],
                             pool->variance[owner]};
      pool->slots[place].cost = PairCost(problem.shape,
                                         window,
                                         problem.views[view],
                                         view,
                                         pool->slopes[plane][owner],
                                         pool->col[owner],
                                         pool->row[owner],
                                         sampler);
    }
    warp.Sync();
    int place = 0;
    for (int view = begin; view < end; ++view) {
      const uint32_t wants = warp.Ballot(wanted >> view & 1);
      const int rank = CountBits(wanted & ((1u << view) - 1));
      place =
          PlacePairs(wants, has_plane, lane, place, [&](int plane, int from) {
            costs[plane * num_wanted + rank] = pool->slots[from].cost;
          });
    }
    warp.Sync();
    begin = end;
  }
  return true;
}

template <class Sampler, class Warp>
class PooledCost : public PixelCost {
 public:
  HPM_HD_MEMBER PooledCost(const DeviceProblem& problem,
                           const Warp& warp,
                           WarpPool* pool,
                           int col,
                           int row)
      : PixelCost(problem, col, row), warp_(warp), pool_(pool) {}

  // `views` in ascending order, as all of src/core gives them.
  HPM_HD_MEMBER void Photometric(const Plane* planes,
                                 int num_planes,
                                 const uint8_t* views,
                                 int num_views,
                                 float* costs) const {
    uint32_t wanted = 0;
    for (int k = 0; k < num_views; ++k) wanted |= 1u << views[k];
    if (wanted == 0) return;
    for (int first = 0; first < num_planes; first += kNumRegions) {
      const int count =
          num_planes - first < kNumRegions ? num_planes - first : kNumRegions;
      for (int i = 0; i < count; ++i) {
        pool_->slopes[i][warp_.lane()] =
            SlopeOf(problem_.params.ref, planes[first + i]);
      }
      EvaluateTogether<Sampler>(
          problem_, warp_, pool_, count, wanted, costs + first * num_views);
    }
    num_evaluations_ += num_planes * num_views;
  }

 private:
  const Warp& warp_;
  WarpPool* pool_;
};

// After the visit, by every lane, also one without a pixel.
template <class Sampler, class Warp>
HPM_HD void ServeOthers(const DeviceProblem& problem,
                        const Warp& warp,
                        WarpPool* pool) {
  while (EvaluateTogether<Sampler>(problem, warp, pool, 0, 0, nullptr)) {
  }
}

}  // namespace hpm
