#include "src/engine/view_propagation.h"

#include "src/base/large_vectors.h"
#include "src/engine/backend.h"
#include "src/engine/source_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr float kSameDepth = 0.015f;  // relative
constexpr int kReach = 2;             // pixels, of a slope's differences
constexpr float kMaxBend = 0.01f;     // of 1/z over the reach, relative
constexpr float kMaxSlope = 0.05f;    // of 1/z per pixel, relative
constexpr float kMinFacing = 0.1f;    // cosine between normal and ray
// Of the mean cost of a plane's best views.
constexpr float kMatches = 0.6f;  // where more, the images do not match
constexpr float kMargin = 0.05f;  // ties say nothing

// What a source found, as planes of the reference's camera frame.
class FoundSurface {
 public:
  FoundSurface(const Camera& ref, const View& src)
      : ref_(ref),
        camera_(src.camera),
        depths_(src.inverse_depth->View()),
        to_ref_(MakeViewWarp(src.camera, ref)),
        rotation_(ref.R * Transposed(src.camera.R)),
        ref_center_(CamFromWorld(src.camera, Center(ref))) {}

  const Camera& camera() const { return camera_; }

  // From the slope of 1/z around a pixel of the source; distance 0 near the
  // border and where the surface bends or is seen edge on.
  Plane PlaneAt(int col, int row) const {
    const Plane none = {{0, 0, 0}, 0};
    if (col < kReach || row < kReach || col + kReach >= camera_.width ||
        row + kReach >= camera_.height) {
      return none;
    }
    const float here = InverseDepth(col, row);
    const float left = InverseDepth(col - kReach, row);
    const float right = InverseDepth(col + kReach, row);
    const float above = InverseDepth(col, row - kReach);
    const float below = InverseDepth(col, row + kReach);
    const float bend = std::max(std::fabs(left + right - 2 * here),
                                std::fabs(above + below - 2 * here));
    const float dcol = (right - left) / (2 * kReach);
    const float drow = (below - above) / (2 * kReach);
    const float slope = std::max(std::fabs(dcol), std::fabs(drow));
    if (!(here > 0) || bend > kMaxBend * here || slope > kMaxSlope * here)
      return none;
    // 1/z = dcol * col + drow * row + constant, hence n . X = 1 with this n.
    const float constant =
        here - dcol * static_cast<float>(col) - drow * static_cast<float>(row);
    const Vec3f n = {dcol * camera_.fx,
                     drow * camera_.fy,
                     dcol * camera_.cx + drow * camera_.cy + constant};
    const float inv_length = 1 / Norm(n);
    const Vec3f normal = -inv_length * n;
    return {rotation_ * normal, inv_length + Dot(normal, ref_center_)};
  }

  // The pixel of the reference that shows this pixel of the source; false where
  // that lies outside.
  bool Land(int col, int row, int* ref_col, int* ref_row) const {
    const Vec3f q =
        to_ref_.M *
            Vec3f{static_cast<float>(col), static_cast<float>(row), 1.0f} +
        InverseDepth(col, row) * to_ref_.v;
    if (!(q.z > 0)) return false;
    const float u = q.x / q.z, v = q.y / q.z;
    if (!(u > -0.5f && v > -0.5f && u < static_cast<float>(ref_.width) - 0.5f &&
          v < static_cast<float>(ref_.height) - 0.5f)) {
      return false;
    }
    // Not negative, so that cutting off rounds.
    const float right = u + 0.5f, below = v + 0.5f;
    *ref_col = static_cast<int>(right);
    *ref_row = static_cast<int>(below);
    return true;
  }

 private:
  float InverseDepth(int col, int row) const {
    const size_t at = static_cast<size_t>(row) * camera_.width + col;
    return depths_.step * InverseDepthSteps(depths_.steps, at);
  }

  const Camera& ref_;
  const Camera& camera_;
  InverseDepths depths_;
  ViewWarp to_ref_;
  Mat3f rotation_;    // from the source's frame to the reference's
  Vec3f ref_center_;  // in the source's frame
};

// How many sources say the same of a pixel.
struct Support {
  uint16_t first : 5;  // who said it first, an index of a surface
  uint16_t last : 5;
  uint16_t count : 6;  // 0: nobody
};
static_assert(kMaxViews <= 32);

void Count(int source, Support* support) {
  if (support->count > 0 && support->last == source) return;
  if (support->count == 0) support->first = source & 31;
  support->last = source & 31;
  ++support->count;
}

// Depths other than a pixel's own that sources propose there.
struct Proposals {
  static constexpr int kMax = 2;
  float inverse_depth[kMax];
  int32_t pixel[kMax];  // of the source that was first
  Support support[kMax];
};

// What sources say of the pixels of the reference.
struct Votes {
  explicit Votes(size_t num_pixels)
      : own(Filled(num_pixels, Support{})),
        others(Filled(num_pixels, Proposals{})) {}

  std::vector<Support> own;  // of the planes that the pixels have
  std::vector<Proposals> others;
};

// Beside them there is a label of a region; all this fits into what is planned
// for a second HypothesisMap.
static_assert(2 * (sizeof(Support) + sizeof(Proposals) + sizeof(uint16_t)) <=
              kEngineBytesPerPixel);

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
      Count(source, support);
      return;
    }
    if (support->count < proposals->support[place].count) place = k;
  }
  if (proposals->support[place].count > 1) return;
  proposals->inverse_depth[place] = inverse_depth;
  proposals->pixel[place] = pixel;
  proposals->support[place] = {};
  Count(source, &proposals->support[place]);
}

// 1/z of a plane on the ray of a pixel; 0 where it is not allowed there.
float AllowedInverseDepth(const ViewSet& views,
                          const Plane& plane,
                          const Vec3f& ray) {
  if (!(plane.distance > 0) ||
      !(Dot(plane.normal, ray) < -kMinFacing * Norm(ray))) {
    return 0;
  }
  const float z = DepthOnRay(plane, ray);
  return z >= views.depth_min && z <= views.depth_max ? 1 / z : 0;
}

// Where a pixel of a source lies in the reference; at < 0: nowhere.
struct Landing {
  ptrdiff_t at;
  float inverse_depth;  // of the source's plane there
  bool agrees;          // with the plane that the pixel has
};

Landing LandingOf(const ViewSet& views,
                  const WeakRegions& regions,
                  const HypothesisMap& map,
                  const FoundSurface& surface,
                  int col,
                  int row) {
  const Landing nowhere = {-1, 0, false};
  const Camera& ref = views.ref.camera;
  int ref_col, ref_row;
  if (!surface.Land(col, row, &ref_col, &ref_row) ||
      regions.At(ref_col, ref_row) > 0) {
    return nowhere;
  }
  const Vec3f ray =
      RayAt(ref, static_cast<float>(ref_col), static_cast<float>(ref_row));
  const float inverse_depth =
      AllowedInverseDepth(views, surface.PlaneAt(col, row), ray);
  if (!(inverse_depth > 0)) return nowhere;
  const auto at = static_cast<ptrdiff_t>(ref_row) * ref.width + ref_col;
  const float own = 1 / DepthOnRay(map.planes[at], ray);
  return {at, inverse_depth, SameDepth(inverse_depth, own)};
}

// Rows of the source are worked out side by side and counted one after the
// other, so that the result depends on no order of threads.
void CountVotes(const ViewSet& views,
                const WeakRegions& regions,
                const HypothesisMap& map,
                const FoundSurface& surface,
                int source,
                const CancelToken* cancel,
                Votes* votes) {
  constexpr int kRowsAtOnce = 64;
  const int width = surface.camera().width;
  const int height = surface.camera().height;
  std::vector<Landing> landings(static_cast<size_t>(width) * kRowsAtOnce);
  for (int begin = 0; begin < height; begin += kRowsAtOnce) {
    if (cancel != nullptr) cancel->ThrowIfCancelled();
    const int end = std::min(height, begin + kRowsAtOnce);
    tbb::parallel_for(begin, end, [&](int row) {
      Landing* of_row = &landings[static_cast<size_t>(row - begin) * width];
      for (int col = 0; col < width; ++col)
        of_row[col] = LandingOf(views, regions, map, surface, col, row);
    });
    const int first_pixel = begin * width;
    for (int i = 0; i < (end - begin) * width; ++i) {
      const Landing& landing = landings[i];
      if (landing.at < 0) continue;
      if (landing.agrees) {
        Count(source, &votes->own[landing.at]);
      } else {
        Propose(landing.inverse_depth,
                first_pixel + i,
                source,
                &votes->others[landing.at]);
      }
    }
  }
}

// Index of the depth that most sources propose, where more propose it than
// agree with the pixel's own plane; negative if there is none.
int BestProposal(const Support& own, const Proposals& others) {
  int best = -1;
  int most = own.count;
  for (int k = 0; k < Proposals::kMax; ++k) {
    if (others.support[k].count <= most) continue;
    most = others.support[k].count;
    best = k;
  }
  return best;
}

// Takes those of the planes that match, and do so better than what the pixels
// have.
void TakeBetter(const ScorePlanes& score,
                std::vector<PixelPlane>* proposed,
                HypothesisMap* map) {
  if (proposed->empty()) return;
  const auto plane_of = [&](const PixelPlane& pixel) -> Plane& {
    return map->planes[static_cast<size_t>(pixel.row) * map->width + pixel.col];
  };
  const std::vector<float> costs = score(*proposed);
  std::vector<size_t> matching;
  std::vector<PixelPlane> own;
  for (size_t i = 0; i < costs.size(); ++i) {
    if (!(costs[i] < kMatches)) continue;
    const PixelPlane& pixel = (*proposed)[i];
    matching.push_back(i);
    own.push_back({pixel.col, pixel.row, plane_of(pixel)});
  }
  const std::vector<float> own_costs = score(own);
  for (size_t k = 0; k < own.size(); ++k) {
    const size_t i = matching[k];
    if (costs[i] + kMargin < own_costs[k])
      plane_of(own[k]) = (*proposed)[i].plane;
  }
  proposed->clear();
}

}  // namespace

void PropagateViews(const ViewSet& views,
                    const WeakRegions& regions,
                    const ScorePlanes& score,
                    const CancelToken* cancel,
                    HypothesisMap* map) {
  constexpr size_t kAskedAtOnce = 1 << 16;
  std::vector<FoundSurface> surfaces;
  for (const View& src : views.srcs) {
    if (src.inverse_depth != nullptr)
      surfaces.emplace_back(views.ref.camera, src);
  }
  if (surfaces.empty()) return;
  Votes votes(map->planes.size());
  for (size_t j = 0; j < surfaces.size(); ++j) {
    CountVotes(
        views, regions, *map, surfaces[j], static_cast<int>(j), cancel, &votes);
  }

  std::vector<PixelPlane> proposed;
  for (int row = 0; row < map->height; ++row) {
    for (int col = 0; col < map->width; ++col) {
      const size_t at = static_cast<size_t>(row) * map->width + col;
      const Proposals& others = votes.others[at];
      const int best = BestProposal(votes.own[at], others);
      if (best < 0) continue;
      const FoundSurface& surface = surfaces[others.support[best].first];
      const int width = surface.camera().width;
      const int pixel = others.pixel[best];
      proposed.push_back(
          {col, row, surface.PlaneAt(pixel % width, pixel / width)});
      if (proposed.size() == kAskedAtOnce) TakeBetter(score, &proposed, map);
    }
  }
  TakeBetter(score, &proposed, map);
  map->Touch();
}

}  // namespace hpm
