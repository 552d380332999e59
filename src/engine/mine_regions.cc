#include "src/engine/mine_regions.h"

#include "src/base/large_vectors.h"
#include "src/engine/source_geometry.h"
#include "src/engine/visit_params.h"
#include "src/prior/region_planes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// So that an image has about as many points as planes need, at any size.
int LatticeStep(const HypothesisMap& map) {
  constexpr double kNumPoints = 30000;
  return std::max(1,
                  static_cast<int>(std::sqrt(map.planes.size() / kNumPoints)));
}

// A source view whose opinion is heard.
struct Witness {
  DepthView view;
  Vec3f center;  // of its camera, in the reference camera frame
};

// The sources that have a depth map.
std::vector<Witness> WitnessesOf(const ViewSet& views) {
  const Camera& ref = views.ref.camera;
  std::vector<Witness> witnesses;
  for (const View& src : views.srcs) {
    if (src.inverse_depth == nullptr) continue;
    witnesses.push_back({DepthViewOf(ref, src), CenterOf(ref, src)});
  }
  return witnesses;
}

// The number of witnesses that bring the pixel of this plane back to within
// max_error pixels; *inverse_depth becomes the mean of what they and the plane
// say, so that the views come to share one surface.
int CountAgreeing(const std::vector<Witness>& witnesses,
                  const Camera& ref,
                  const Plane& plane,
                  float col,
                  float row,
                  float max_error,
                  float* inverse_depth) {
  const PlaneSlope slope = SlopeOf(ref, plane);
  const auto of_plane = [&](float c, float r) {
    return -(slope.col * c + slope.row * r + slope.constant);
  };
  const Vec3f point = (1 / of_plane(col, row)) * RayAt(ref, col, row);
  int count = 0;
  float sum = 0;
  for (const Witness& witness : witnesses) {
    if (Dot(witness.center - point, plane.normal) <= 0) continue;  // its back
    const Reprojection back = Reproject(witness.view, slope, col, row);
    // What is not there has the largest error, which does not agree.
    if (!(ReprojectionError(back, col, row, 2 * max_error) <= max_error))
      continue;
    ++count;
    sum += back.inverse_depth - of_plane(back.col, back.row);
  }
  *inverse_depth = of_plane(col, row) + sum / static_cast<float>(count + 1);
  return count;
}

// How many witnesses have the median pixel in their image; one at least. Those
// that look at but a part of the image, zoomed in or turned away, cannot agree
// on the rest.
int NumSeeingMost(const std::vector<Witness>& witnesses,
                  const Camera& ref,
                  const HypothesisMap& map,
                  int step) {
  std::vector<ptrdiff_t> counts;
  for (int row = 0; row < map.height; row += step) {
    for (int col = 0; col < map.width; col += step) {
      const Plane& plane =
          map.planes[static_cast<size_t>(row) * map.width + col];
      if (!(plane.distance > 0)) continue;
      const PlaneSlope slope = SlopeOf(ref, plane);
      float u, v;
      counts.push_back(std::count_if(
          witnesses.begin(), witnesses.end(), [&](const Witness& witness) {
            return IsSeen(witness.view.to_src,
                          slope,
                          static_cast<float>(col),
                          static_cast<float>(row),
                          &u,
                          &v);
          }));
    }
  }
  if (counts.empty()) return 1;
  const auto middle =
      counts.begin() + static_cast<ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return std::max(1, static_cast<int>(*middle));
}

struct Pixel {
  int col, row;
};

// Those of the pixels that at least `needed` views agree on.
std::vector<ReliablePoint> ReliablePoints(const std::vector<Witness>& witnesses,
                                          const Camera& ref,
                                          float max_error,
                                          int needed,
                                          const HypothesisMap& map,
                                          const std::vector<Pixel>& pixels) {
  constexpr size_t kChunk = 1024;
  const size_t num_chunks = (pixels.size() + kChunk - 1) / kChunk;
  std::vector<std::vector<ReliablePoint>> of_chunk(num_chunks);
  tbb::parallel_for(size_t{0}, num_chunks, [&](size_t chunk) {
    const size_t end = std::min(pixels.size(), (chunk + 1) * kChunk);
    for (size_t i = chunk * kChunk; i < end; ++i) {
      const auto [col, row] = pixels[i];
      const Plane& plane =
          map.planes[static_cast<size_t>(row) * map.width + col];
      if (!(plane.distance > 0)) continue;
      float inverse_depth;
      const int count = CountAgreeing(witnesses,
                                      ref,
                                      plane,
                                      static_cast<float>(col),
                                      static_cast<float>(row),
                                      max_error,
                                      &inverse_depth);
      if (count >= needed) of_chunk[chunk].push_back({col, row, inverse_depth});
    }
  });
  std::vector<ReliablePoint> points;
  for (const auto& chunk : of_chunk)
    points.insert(points.end(), chunk.begin(), chunk.end());
  return points;
}

// Every step-th pixel of every step-th row that lies in a region.
std::vector<Pixel> LatticePixels(const WeakRegions& regions, int step) {
  std::vector<Pixel> pixels;
  for (int row = 0; row < regions.height; row += step) {
    for (int col = 0; col < regions.width; col += step) {
      if (regions.At(col, row) > 0) pixels.push_back({col, row});
    }
  }
  return pixels;
}

// Of each region, by its label, the share of its pixels that are reliable.
std::vector<float> AgreementOf(const WeakRegions& regions,
                               const std::vector<Pixel>& pixels,
                               const std::vector<ReliablePoint>& reliable) {
  const auto count = [&](const auto& points) {
    std::vector<int> counts(regions.num_regions + 1, 0);
    for (const auto& point : points) ++counts[regions.At(point.col, point.row)];
    return counts;
  };
  const std::vector<int> all = count(pixels);
  const std::vector<int> agreeing = count(reliable);
  std::vector<float> shares(all.size(), 0);
  for (size_t label = 1; label < all.size(); ++label)
    shares[label] = static_cast<float>(agreeing[label]) /
                    static_cast<float>(std::max(1, all[label]));
  return shares;
}

// The rims of the regions, and per pixel whether it lies in one, farther than
// kRimWidth from anything else.
struct Outlines {
  std::vector<Pixel> rim;  // row by row
  std::vector<bool> inner;
};

Outlines OutlinesOf(const WeakRegions& regions) {
  Outlines outlines;
  outlines.inner.resize(regions.label.size());
  std::vector<std::vector<Pixel>> of_row(regions.height);
  regions.ForEachBand([&](const Rows& rows) {
    const LabelWindows windows(regions, rows, kRimWidth);
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int col = 0; col < regions.width; ++col) {
        const int greatest = windows.Greatest(col, row);
        if (greatest == 0) continue;
        if (regions.At(col, row) == 0) {
          of_row[row].push_back({col, row});
        } else if (windows.Least(col, row) == greatest) {
          outlines.inner[static_cast<size_t>(row) * regions.width + col] = true;
        }
      }
    }
  });
  for (const auto& row : of_row)
    outlines.rim.insert(outlines.rim.end(), row.begin(), row.end());
  return outlines;
}

// The plane of densest support around the pixel whose depth there is allowed;
// null if there is none.
const Plane* NearestPlane(const RegionPlanes& planes,
                          int label,
                          const ViewSet& views,
                          int col,
                          int row) {
  const RegionPlane* best = nullptr;
  const size_t cell = planes.CellAt(col, row);
  for (const RegionPlane& candidate : planes.of_region[label]) {
    if (best != nullptr && candidate.nearness[cell] <= best->nearness[cell])
      continue;
    const float z = DepthAt(views.ref.camera,
                            candidate.plane,
                            static_cast<float>(col),
                            static_cast<float>(row));
    if (z >= views.depth_min && z <= views.depth_max) best = &candidate;
  }
  return best == nullptr ? nullptr : &best->plane;
}

}  // namespace

// Numbers from the share of true planes among the candidates of four rendered
// scenes; why this evidence counts: docs/algorithm.md, "A plane needs
// evidence of its own".
bool IsBelievable(const RegionPlane& plane, const PlaneEvidence& evidence) {
  constexpr double kDistinct = 0.01, kContradicted = -0.01;  // cost
  constexpr double kMinSpread = 0.05;
  constexpr double kMinScore = 0.25, kBehindWeight = 2, kInsideWeight = 0.3;
  constexpr double kMostOfInside = 0.5, kMaxBehind = 0.3;
  if (evidence.num_pixels == 0 || evidence.distinctness < kContradicted)
    return false;
  if (evidence.distinctness >= kDistinct) return true;
  const double score = plane.rim_on - kBehindWeight * plane.rim_behind +
                       kInsideWeight * plane.inside;
  return plane.spread >= kMinSpread &&
         (score >= kMinScore ||
          (plane.inside >= kMostOfInside && plane.rim_behind < kMaxBehind));
}

MinedRegions MineRegions(const ViewSet& views,
                         const WeakRegions& regions,
                         const MethodParams& params,
                         const HypothesisMap& map,
                         uint64_t key,
                         const ScorePlanes& score) {
  const std::vector<Witness> witnesses = WitnessesOf(views);
  if (witnesses.empty() || regions.num_regions == 0) return {};
  const int step = LatticeStep(map);
  const int needed =
      std::min(params.region_min_consistent,
               NumSeeingMost(witnesses, views.ref.camera, map, step));
  const auto reliable = [&](const std::vector<Pixel>& pixels) {
    return ReliablePoints(witnesses,
                          views.ref.camera,
                          params.region_max_error,
                          needed,
                          map,
                          pixels);
  };
  const std::vector<Pixel> lattice = LatticePixels(regions, step);
  const std::vector<ReliablePoint> inside = reliable(lattice);
  Outlines outlines = OutlinesOf(regions);
  RegionPlanes planes =
      FindRegionPlanes(regions,
                       views.ref.camera,
                       inside,
                       reliable(outlines.rim),
                       step,
                       params.region_max_residual / Parallax(views),
                       CombineBits(views.random_key, key));
  outlines.rim = {};
  const auto evidence =
      FindEvidence(views, regions, planes, step, params.patch_radius, score);
  for (size_t label = 1; label < planes.of_region.size(); ++label) {
    std::vector<RegionPlane> believed;
    for (size_t k = 0; k < planes.of_region[label].size(); ++k) {
      RegionPlane& plane = planes.of_region[label][k];
      if (IsBelievable(plane, evidence[label][k]))
        believed.push_back(std::move(plane));
    }
    planes.of_region[label] = std::move(believed);
  }
  MinedRegions result = {Filled(map.planes.size(), Plane{{0, 0, 0}, 0}),
                         std::move(outlines.inner),
                         AgreementOf(regions, lattice, inside)};
  regions.ForEachBand([&](const Rows& rows) {
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int col = 0; col < regions.width; ++col) {
        const int label = regions.At(col, row);
        if (label == 0) continue;
        const Plane* plane = NearestPlane(planes, label, views, col, row);
        if (plane == nullptr) continue;
        const size_t at = static_cast<size_t>(row) * regions.width + col;
        result.priors[at] = *plane;
        result.unexplained[at] = false;
      }
    }
  });
  return result;
}

}  // namespace hpm
