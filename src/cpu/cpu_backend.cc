#include "src/cpu/cpu_backend.h"

#include "src/cpu/cpu_views.h"
#include "src/cpu/pixel_group.h"
#include "src/engine/sweeps.h"
#include "src/engine/visit_params.h"
#include "src/engine/work_estimate.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace hpm {
namespace {

constexpr size_t kPlanesPerTask = 64;

// Pixels are visited tile by tile. What a visit reads, windows in all sources
// and hypotheses around, the next rows of the tile find in the core's cache;
// rows of a whole image are too long for that. A tile's columns are those of
// whole groups.
constexpr int kTileCols = 8 * kMaxGroup;
constexpr int kTileRows = 16;
// Of small images, which fit into the cache anyhow, so that all threads have
// work.
constexpr int kSmallTileRows = 4;
constexpr int kTilesPerThread = 8;

int Ceil(int a, int b) { return (a + b - 1) / b; }

class CpuBackend : public Backend {
 public:
  CpuBackend(CpuTarget target, int num_threads)
      : target_(std::move(target)),
        arena_(num_threads > 0 ? num_threads
                               : tbb::this_task_arena::max_concurrency()) {}

  std::string Name() const override {
    return fmt::format(
        "cpu {}, {} threads", target_.name, arena_.max_concurrency());
  }

  uint64_t MemoryNeeded(int width, int height, int num_srcs) const override {
    return kEngineBytesPerPixel * width * height +
           CpuViews::MemoryNeeded(width, height, num_srcs);
  }

  void SetViews(const ViewSet& views, const MethodParams& params) override {
    ForgetViews();
    views_.emplace(views, params);
    num_evaluations_ = 0;
    random_key_ = views.random_key;
    visit_ = MakeVisitParams(views, params);
    method_ = params;
  }

  void ForgetViews() override { views_.reset(); }

  void Run(const Pass& pass,
           const SamplingPattern& pattern,
           HypothesisMap* map,
           const RunControl& control) override {
    const PixelState state = map->View();
    const VisitParams params = ForPass(visit_, method_, pass);
    int step = 0;
    for (const Sweep& sweep : SweepsOf(pass, random_key_)) {
      RunSweep(params, pattern, sweep, state, control);
      if (CountsAsStep(sweep.kind) && control.progress)
        control.progress(StepsWork(pass, ++step) / PassWork(pass));
    }
    map->Touch();
  }

  std::vector<float> Score(const std::vector<PixelPlane>& planes,
                           const RunControl& control) override {
    std::vector<float> costs(planes.size());
    arena_.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<size_t>(0, planes.size(), kPlanesPerTask),
          [&](const tbb::blocked_range<size_t>& range) {
            if (control.cancel->cancelled()) return;
            uint64_t num_evaluations = 0;
            for (size_t i = range.begin(); i < range.end(); ++i) {
              const CpuPixelCost cost = CostAt(planes[i].col, planes[i].row);
              costs[i] = CostFromAllViews(visit_, cost, planes[i].plane);
              num_evaluations += cost.num_evaluations();
            }
            num_evaluations_ += num_evaluations;
          });
    });
    control.cancel->ThrowIfCancelled();
    return costs;
  }

  std::vector<uint32_t> ConsistentViews(const HypothesisMap& map,
                                        const FilterParams& filter,
                                        bool geometric,
                                        const RunControl& control) override {
    VisitParams params = visit_;
    params.geometric = geometric;
    std::vector<uint32_t> consistent(map.planes.size());
    const PixelState size = {
        map.width, map.height, nullptr, nullptr, nullptr, nullptr};
    for (int color = 0; color < 2; ++color) {
      HalfSweep(size, color, control, [&](int col, int row) {
        const size_t at = static_cast<size_t>(row) * map.width + col;
        const CpuPixelCost cost = CostAt(col, row);
        consistent[at] = hpm::ConsistentViews(params,
                                              filter,
                                              views_->src_centers().data(),
                                              cost,
                                              map.planes[at],
                                              col,
                                              row);
        return cost.num_evaluations();
      });
    }
    return consistent;
  }

  uint64_t num_cost_evaluations() const override { return num_evaluations_; }

 private:
  CpuPixelCost CostAt(int col, int row) const {
    return {*views_, target_, visit_.geometric_term.max_error, col, row};
  }

  void RunSweep(const VisitParams& params,
                const SamplingPattern& pattern,
                const Sweep& sweep,
                const PixelState& state,
                const RunControl& control) {
    const SweepScope scope = {params, pattern, sweep, state, nullptr, nullptr};
    if (sweep.kind == SweepKind::kInitialize ||
        sweep.kind == SweepKind::kUpdate) {
      ForEachTile(state, control, [&](const Tile& tile) {
        PixelGroup group(*views_, target_, scope);
        for (int row = tile.row_begin; row < tile.row_end; ++row) {
          if (control.cancel->cancelled()) break;
          int col = tile.col_begin + (row + sweep.color) % 2;
          while (col < tile.col_end) col = group.Visit(col, row);
        }
        return group.num_evaluations();
      });
    } else {
      HalfSweep(state, sweep.color, control, [&](int col, int row) {
        VisitPixel(params, sweep, state, col, row);
        return uint64_t{0};
      });
    }
  }

  // Calls visit(col, row) for all pixels of one colour; it returns the number
  // of cost evaluations.
  template <class Visit>
  void HalfSweep(const PixelState& state,
                 int color,
                 const RunControl& control,
                 const Visit& visit) {
    ForEachTile(state, control, [&](const Tile& tile) {
      uint64_t num_evaluations = 0;
      for (int row = tile.row_begin; row < tile.row_end; ++row) {
        if (control.cancel->cancelled()) break;
        int col = tile.col_begin + (row + color) % 2;
        for (; col < tile.col_end; col += 2) num_evaluations += visit(col, row);
      }
      return num_evaluations;
    });
  }

  struct Tile {
    int col_begin, col_end, row_begin, row_end;
  };

  // Calls work(tile) for all tiles, in parallel; it returns the number of cost
  // evaluations.
  template <class Work>
  void ForEachTile(const PixelState& state,
                   const RunControl& control,
                   const Work& work) {
    const int across = Ceil(state.width, kTileCols);
    const int wanted = kTilesPerThread * arena_.max_concurrency();
    const bool small = across * Ceil(state.height, kTileRows) < wanted;
    const int num_rows = small ? kSmallTileRows : kTileRows;
    arena_.execute([&] {
      tbb::parallel_for(
          0,
          across * Ceil(state.height, num_rows),
          [&](int i) {
            if (control.cancel->cancelled()) return;
            const int col = i % across * kTileCols;
            const int row = i / across * num_rows;
            num_evaluations_ +=
                work(Tile{col,
                          std::min(col + kTileCols, state.width),
                          row,
                          std::min(row + num_rows, state.height)});
          },
          tbb::simple_partitioner());
    });
    control.cancel->ThrowIfCancelled();
  }

  CpuTarget target_;
  tbb::task_arena arena_;
  std::optional<CpuViews> views_;
  VisitParams visit_;
  MethodParams method_;
  uint64_t random_key_ = 0;
  std::atomic<uint64_t> num_evaluations_{0};
};

}  // namespace

std::unique_ptr<Backend> MakeCpuBackend(const CpuTarget& target,
                                        int num_threads) {
  return std::make_unique<CpuBackend>(target, num_threads);
}

std::unique_ptr<Backend> MakeCpuBackend(const std::string& target,
                                        int num_threads) {
  return MakeCpuBackend(FindCpuTarget(target), num_threads);
}

}  // namespace hpm
