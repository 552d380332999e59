#include "src/engine/view_votes.h"

#include "src/engine/backend.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr float kSameDepth = 0.015f;  // relative
constexpr int kRowsPerTask = 16;      // that vote
constexpr int kTasksAtOnce = 8;

// Images of 400 pixels are a little worse with cells of 2x2, those of 640 are
// not (docs/benchmarks.md).
constexpr int kLargeSide = 1000;  // pixels

// Beside these there is a label of a region; all fits into what is planned for
// a second HypothesisMap.
static_assert(2 * (sizeof(Support) + sizeof(Proposals) + sizeof(uint16_t)) <=
              kEngineBytesPerPixel);

int CellOf(const HypothesisMap& map) {
  return std::max(map.width, map.height) > kLargeSide ? 2 : 1;
}

int NumCells(int num_pixels, int cell) {
  return (num_pixels + cell - 1) / cell;
}

void CountSource(int source, Support* support) {
  if (support->count > 0 && support->last == source) return;
  if (support->count == 0) support->first = source & 31;
  support->last = source & 31;
  ++support->count;
}

bool SameDepth(float inverse_depth, float other) {
  return std::fabs(inverse_depth - other) < kSameDepth * other;
}

// Gives the depth a place if there is one: one of which a single source speaks
// makes room.
void Propose(float inverse_depth,
             int32_t pixel,
             int source,
             Proposals* proposals) {
  int place = 0;
  for (int k = 0; k < Proposals::kMax; ++k) {
    Support* support = &proposals->support[k];
    if (support->count > 0 &&
        SameDepth(proposals->inverse_depth[k], inverse_depth)) {
      CountSource(source, support);
      return;
    }
    if (support->count < proposals->support[place].count) place = k;
  }
  if (proposals->support[place].count > 1) return;
  proposals->inverse_depth[place] = inverse_depth;
  proposals->pixel[place] = pixel;
  proposals->support[place] = {};
  CountSource(source, &proposals->support[place]);
}

// What a pixel of a source says of where it lands.
struct Vote {
  int32_t cell;
  int32_t pixel;        // in the source
  float inverse_depth;  // 0: that of the plane it has
};

// Works out the votes of a few rows of a source at a time, of every cell-th
// pixel of every cell-th row; keeps its memory.
class RowVotes {
 public:
  // Of the rows cell * i, i in [first, end), not within kReach of the border.
  void Find(const HypothesisMap& map,
            const WeakRegions& regions,
            const FoundSurface& surface,
            int cell,
            int first,
            int end) {
    num_ = 0;
    const int reach = kReach / cell;  // entries
    const int num_cols = NumCells(surface.width(), cell);
    const int num_inner = num_cols - 2 * reach;
    if (first >= end || num_inner <= 0) return;
    const size_t stride = num_cols + kMaxLandingLanes;
    inverse_depths_.resize(stride * (end - first + 2 * reach));
    float* values = inverse_depths_.data();
    for (int i = first - reach; i < end + reach; ++i, values += stride) {
      for (int k = 0; k < num_cols; ++k)
        values[k] = surface.InverseDepth(cell * k, cell * i);
    }
    votes_.resize(static_cast<size_t>(num_inner) * (end - first));
    landings_.resize(num_inner + kMaxLandingLanes);
    for (int i = first; i < end; ++i) {
      const float* row = &inverse_depths_[stride * (i - first + reach)];
      LandRow(surface.pose(),
              {row + reach,
               row,
               row + 2 * reach,
               row + reach - reach * stride,
               row + reach + reach * stride},
              kReach,
              cell,
              cell * i,
              num_inner,
              landings_.data());
      AddRow(map,
             regions,
             surface,
             cell,
             cell * i * surface.width() + kReach,
             num_inner);
    }
  }

  const Vote* begin() const { return votes_.data(); }
  const Vote* end() const { return votes_.data() + num_; }

 private:
  void AddRow(const HypothesisMap& map,
              const WeakRegions& regions,
              const FoundSurface& surface,
              int cell,
              int first_pixel,
              int num) {
    const int num_cell_cols = NumCells(map.width, cell);
    for (int k = 0; k < num; ++k) {
      const Landing& landing = landings_[k];
      if (landing.col < 0) continue;
      const size_t at =
          static_cast<size_t>(landing.row) * map.width + landing.col;
      if (regions.label[at] > 0) continue;
      const float own = 1 / DepthAt(surface.pose().ref,
                                    map.planes[at],
                                    static_cast<float>(landing.col),
                                    static_cast<float>(landing.row));
      const bool agrees = SameDepth(landing.inverse_depth, own);
      votes_[num_++] = {landing.row / cell * num_cell_cols + landing.col / cell,
                        first_pixel + cell * k,
                        agrees ? 0 : landing.inverse_depth};
    }
  }

  std::vector<float> inverse_depths_;
  std::vector<Landing> landings_;  // of a row
  std::vector<Vote> votes_;
  size_t num_ = 0;
};

}  // namespace

FoundSurface::FoundSurface(const ViewSet& views, const View& src)
    : depths_(src.inverse_depth->View()),
      pose_{views.ref.camera,
            src.camera,
            MakeViewWarp(src.camera, views.ref.camera),
            views.ref.camera.R * Transposed(src.camera.R),
            CamFromWorld(src.camera, Center(views.ref.camera)),
            views.depth_min,
            views.depth_max} {}

Plane FoundSurface::PlaneAt(int col, int row) const {
  return PlaneOfSource(pose_,
                       {InverseDepth(col, row),
                        InverseDepth(col - kReach, row),
                        InverseDepth(col + kReach, row),
                        InverseDepth(col, row - kReach),
                        InverseDepth(col, row + kReach)},
                       col,
                       row);
}

ViewVotes::ViewVotes(const ViewSet& views,
                     const WeakRegions& regions,
                     const HypothesisMap& map,
                     const CancelToken* cancel)
    : cell_(CellOf(map)),
      num_cols_(NumCells(map.width, cell_)),
      num_rows_(NumCells(map.height, cell_)) {
  for (const View& src : views.srcs) {
    if (src.inverse_depth != nullptr) surfaces_.emplace_back(views, src);
  }
  if (surfaces_.empty()) return;
  own_.resize(static_cast<size_t>(num_cols_) * num_rows_);
  others_.resize(own_.size());
  std::vector<RowVotes> tasks(kTasksAtOnce);
  for (size_t j = 0; j < surfaces_.size(); ++j) {
    const FoundSurface& surface = surfaces_[j];
    const int source = static_cast<int>(j);
    const int reach = kReach / cell_;
    const int end_row = NumCells(surface.height(), cell_) - reach;
    // Some rows are worked out side by side and counted one after the other, so
    // that the result depends on no order of threads.
    for (int begin = reach; begin < end_row;
         begin += kRowsPerTask * kTasksAtOnce) {
      if (cancel != nullptr) cancel->ThrowIfCancelled();
      tbb::parallel_for(0, kTasksAtOnce, [&](int task) {
        const int first = begin + task * kRowsPerTask;
        tasks[task].Find(map,
                         regions,
                         surface,
                         cell_,
                         first,
                         std::min(end_row, first + kRowsPerTask));
      });
      for (const RowVotes& task : tasks) {
        for (const Vote& vote : task) {
          if (vote.inverse_depth > 0) {
            Propose(
                vote.inverse_depth, vote.pixel, source, &others_[vote.cell]);
          } else {
            CountSource(source, &own_[vote.cell]);
          }
        }
      }
    }
  }
}

Plane ViewVotes::Winner(int cell_col, int cell_row) const {
  const Plane none = {{0, 0, 0}, 0};
  if (surfaces_.empty()) return none;
  const size_t cell = static_cast<size_t>(cell_row) * num_cols_ + cell_col;
  const Proposals& others = others_[cell];
  int best = -1;
  int most = own_[cell].count;
  for (int k = 0; k < Proposals::kMax; ++k) {
    if (others.support[k].count <= most) continue;
    most = others.support[k].count;
    best = k;
  }
  if (best < 0) return none;
  const FoundSurface& surface = surfaces_[others.support[best].first];
  return surface.PlaneAt(others.pixel[best] % surface.width(),
                         others.pixel[best] / surface.width());
}

}  // namespace hpm
