#include "src/engine/view_propagation.h"

#include "src/engine/backend.h"
#include "src/engine/source_geometry.h"
#include "src/prior/weak_regions.h"

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
constexpr float kMatches = 0.6f;  // cost; where more, the images do not match
constexpr float kMargin = 0.05f;  // of cost; ties say nothing

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
    *ref_col = static_cast<int>(u + 0.5f);
    *ref_row = static_cast<int>(v + 0.5f);
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

// A depth at a pixel of the reference, and who found it.
struct Proposal {
  float inverse_depth;
  int32_t pixel;  // of the first one that found it
  uint8_t first;  // index of a surface
  uint8_t last;
  uint8_t count;  // of surfaces; 0: no proposal
};

// They take no more memory than is planned beside a HypothesisMap.
constexpr int kMaxProposals = 2;
static_assert(2 * kMaxProposals * sizeof(Proposal) <= kEngineBytesPerPixel);

bool SameDepth(float inverse_depth, float other) {
  return std::fabs(inverse_depth - other) < kSameDepth * other;
}

// Counts the surface for what it says of a pixel; those that come first keep
// the places.
void Propose(const Proposal& proposal, Proposal* of_pixel) {
  for (int k = 0; k < kMaxProposals; ++k) {
    Proposal& place = of_pixel[k];
    if (place.count == 0) {
      place = proposal;
      return;
    }
    if (!SameDepth(place.inverse_depth, proposal.inverse_depth)) continue;
    if (place.last != proposal.last) ++place.count;
    place.last = proposal.last;
    return;
  }
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
  float inverse_depth;
};

Landing LandingOf(const ViewSet& views,
                  const WeakRegions& regions,
                  const FoundSurface& surface,
                  int col,
                  int row) {
  const Landing nowhere = {-1, 0};
  const Camera& ref = views.ref.camera;
  int ref_col, ref_row;
  if (!surface.Land(col, row, &ref_col, &ref_row) ||
      regions.At(ref_col, ref_row) > 0) {
    return nowhere;
  }
  const float inverse_depth = AllowedInverseDepth(
      views,
      surface.PlaneAt(col, row),
      RayAt(ref, static_cast<float>(ref_col), static_cast<float>(ref_row)));
  if (!(inverse_depth > 0)) return nowhere;
  return {static_cast<ptrdiff_t>(ref_row) * ref.width + ref_col, inverse_depth};
}

// Rows of the source are worked out side by side and counted one after the
// other, so that the result depends on no order of threads.
void AddProposals(const ViewSet& views,
                  const WeakRegions& regions,
                  const FoundSurface& surface,
                  uint8_t index,
                  std::vector<Proposal>* proposals) {
  constexpr int kRowsAtOnce = 64;
  const int width = surface.camera().width;
  const int height = surface.camera().height;
  std::vector<Landing> landings(static_cast<size_t>(width) * kRowsAtOnce);
  for (int begin = 0; begin < height; begin += kRowsAtOnce) {
    const int end = std::min(height, begin + kRowsAtOnce);
    tbb::parallel_for(begin, end, [&](int row) {
      Landing* of_row = &landings[static_cast<size_t>(row - begin) * width];
      for (int col = 0; col < width; ++col)
        of_row[col] = LandingOf(views, regions, surface, col, row);
    });
    const int first_pixel = begin * width;
    for (int i = 0; i < (end - begin) * width; ++i) {
      const Landing& landing = landings[i];
      if (landing.at < 0) continue;
      Propose({landing.inverse_depth, first_pixel + i, index, index, 1},
              &(*proposals)[landing.at * kMaxProposals]);
    }
  }
}

// What most surfaces propose, where more propose it than the pixel's own plane;
// null if there is nothing.
const Proposal* BestProposal(const Proposal* of_pixel,
                             float own_inverse_depth) {
  const Proposal* best = nullptr;
  int least = 0;
  for (int k = 0; k < kMaxProposals; ++k) {
    const Proposal& proposal = of_pixel[k];
    if (proposal.count > 0 &&
        SameDepth(proposal.inverse_depth, own_inverse_depth)) {
      least += proposal.count;
    } else if (proposal.count > (best != nullptr ? best->count : 0)) {
      best = &proposal;
    }
  }
  return best != nullptr && best->count > least ? best : nullptr;
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
                    const MethodParams& params,
                    const ScorePlanes& score,
                    HypothesisMap* map) {
  constexpr size_t kAskedAtOnce = 1 << 16;
  const Camera& ref = views.ref.camera;
  std::vector<FoundSurface> surfaces;
  for (const View& src : views.srcs) {
    if (src.inverse_depth != nullptr) surfaces.emplace_back(ref, src);
  }
  if (surfaces.empty()) return;
  const WeakRegions regions = FindWeakRegions(
      *views.ref.image, params.weak_gradient, params.region_min_share);
  std::vector<Proposal> proposals(map->planes.size() * kMaxProposals);
  for (size_t j = 0; j < surfaces.size(); ++j) {
    AddProposals(
        views, regions, surfaces[j], static_cast<uint8_t>(j), &proposals);
  }

  std::vector<PixelPlane> proposed;
  for (int row = 0; row < map->height; ++row) {
    for (int col = 0; col < map->width; ++col) {
      const size_t at = static_cast<size_t>(row) * map->width + col;
      const float own = 1 / DepthAt(ref,
                                    map->planes[at],
                                    static_cast<float>(col),
                                    static_cast<float>(row));
      const Proposal* best = BestProposal(&proposals[at * kMaxProposals], own);
      if (best == nullptr) continue;
      const FoundSurface& surface = surfaces[best->first];
      const int width = surface.camera().width;
      proposed.push_back(
          {col,
           row,
           surface.PlaneAt(best->pixel % width, best->pixel / width)});
      if (proposed.size() == kAskedAtOnce) TakeBetter(score, &proposed, map);
    }
  }
  TakeBetter(score, &proposed, map);
  map->Touch();
}

}  // namespace hpm
