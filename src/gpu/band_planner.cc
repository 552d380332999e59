#include "src/gpu/band_planner.h"

#include <algorithm>
#include <cmath>

namespace hpm {
namespace {

constexpr double kFirstRows = 64;
constexpr double kMaxGrowth = 4;

}  // namespace

BandPlanner::BandPlanner(double target_seconds)
    : target_seconds_(target_seconds) {
  rows_.fill(kFirstRows);
}

int BandPlanner::NextRows(SweepKind kind,
                          int rows_left,
                          int tile_height) const {
  const double asked =
      std::min(rows_[static_cast<size_t>(kind)], double{1 << 30});
  const int tiles = std::max(1, static_cast<int>(asked / tile_height));
  return static_cast<int>(
      std::min<int64_t>(rows_left, static_cast<int64_t>(tiles) * tile_height));
}

void BandPlanner::Report(SweepKind kind, int num_rows, double seconds) {
  double& rows = rows_[static_cast<size_t>(kind)];
  const double most = kMaxGrowth * std::max(rows, double(num_rows));
  rows =
      seconds > 0 ? std::min(num_rows * target_seconds_ / seconds, most) : most;
  rows = std::max(rows, 1.0);
}

}  // namespace hpm
