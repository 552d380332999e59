#include "src/engine/settled_pixels.h"

#include "src/base/large_vectors.h"
#include "src/engine/visit_params.h"
#include "src/prior/region_planes.h"

#include <cmath>
#include <cstddef>

namespace hpm {
namespace {

// In the source view of the largest parallax.
constexpr float kSameSurface = 1;  // pixels

// Iterations of a search that visit a pixel without texture: by then it has
// seen what comes in from an edge nearby.
constexpr uint8_t kPlainVisits = 2;

// Whether two planes meet the ray of a pixel at nearly the same depth.
class SameSurface {
 public:
  explicit SameSurface(const ViewSet& views)
      : ref_(views.ref.camera), tolerance_(kSameSurface / Parallax(views)) {}

  bool operator()(const Plane& a, const Plane& b, int col, int row) const {
    const Vec3f ray =
        RayAt(ref_, static_cast<float>(col), static_cast<float>(row));
    return std::fabs(1 / DepthOnRay(a, ray) - 1 / DepthOnRay(b, ray)) <
           tolerance_;
  }

 private:
  const Camera& ref_;
  float tolerance_;  // of 1/z
};

// How far from the rim a pixel lies deep inside, in pixels: neither its window
// nor those of its neighbours, up to three pixels away, reach anything else.
int Margin(const MethodParams& params) {
  return params.patch_radius + kRimWidth;
}

// None for pixels deep inside a region for which is_settled(col, row, at),
// `plain` for others without texture.
template <class IsSettled>
std::vector<uint8_t> VisitsOf(const WeakRegions& regions,
                              int margin,
                              uint8_t plain,
                              const IsSettled& is_settled) {
  std::vector<uint8_t> visits = Filled(regions.label.size(), kAllVisits);
  regions.ForEachBand([&](const Rows& rows) {
    const LabelWindows windows(regions, rows, margin);
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int col = 0; col < regions.width; ++col) {
        const size_t at = static_cast<size_t>(row) * regions.width + col;
        if (regions.label[at] == 0) continue;
        const int least = windows.Least(col, row);
        const bool deep = least > 0 && least == windows.Greatest(col, row);
        visits[at] = deep && is_settled(col, row, at) ? 0 : plain;
      }
    }
  });
  return visits;
}

}  // namespace

std::vector<uint8_t> VisitsByTexture(const WeakRegions& regions) {
  std::vector<uint8_t> visits = Filled(regions.label.size(), kAllVisits);
  for (size_t at = 0; at < visits.size(); ++at)
    if (regions.label[at] != 0) visits[at] = kPlainVisits;
  return visits;
}

std::vector<uint8_t> VisitsBelowCoarserLevel(const ViewSet& views,
                                             const WeakRegions& regions,
                                             const MethodParams& params,
                                             const HypothesisMap& map) {
  const int margin = Margin(params);
  const SameSurface same_surface(views);
  return VisitsOf(
      regions, margin, kPlainVisits, [&](int col, int row, size_t at) {
        const Plane& own = map.planes[at];
        if (!(own.distance > 0)) return false;
        const int dcol[4] = {margin, -margin, 0, 0};
        const int drow[4] = {0, 0, margin, -margin};
        for (int k = 0; k < 4; ++k) {
          const int c = col + dcol[k], r = row + drow[k];
          if (c < 0 || r < 0 || c >= regions.width || r >= regions.height)
            continue;
          const Plane& other =
              map.planes[static_cast<size_t>(r) * regions.width + c];
          if (!(other.distance > 0) || !same_surface(own, other, c, r))
            return false;
        }
        return true;
      });
}

void SettleOnPriors(const ViewSet& views,
                    const WeakRegions& regions,
                    const MethodParams& params,
                    HypothesisMap* map) {
  if (map->priors.empty()) return;
  const SameSurface same_surface(views);
  map->visits = VisitsOf(
      regions, Margin(params), kAllVisits, [&](int col, int row, size_t at) {
        const Plane& prior = map->priors[at];
        Plane* own = &map->planes[at];
        if (!(prior.distance > 0) || !(own->distance > 0) ||
            !same_surface(prior, *own, col, row))
          return false;
        *own = prior;
        return true;
      });
  map->Touch();
}

}  // namespace hpm
