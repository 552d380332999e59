#include "src/prior/region_planes.h"

#include "src/core/rng.h"
#include "src/core/warp.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <opencv2/imgproc.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr int kMaxPlanes = 4;
constexpr int kMinPoints = 20;
constexpr double kMinSupport = 0.08;  // share of a region's reliable points
constexpr int kNumDraws = 300;
constexpr int kNumRefits = 3;
constexpr size_t kMaxPoints = 4000;  // used of a region
// A candidate has at least so much of the inside or of the rim.
constexpr double kMinInside = 0.1, kMinRim = 0.15;
constexpr int kCellsPerSide = 100;  // of the grid in which support is counted
constexpr double kNearCells = 4, kFarCells = 16;  // blur of the support
constexpr float kFarWeight = 1e-3f, kAnywhereWeight = 1e-6f;

// A plane in the image: 1/z = x . (col, row, 1).
using ImagePlane = Eigen::Vector3d;

struct SupportedPlane {
  ImagePlane plane;
  std::vector<ReliablePoint> support;
};

// 1/z by which the plane lies in front of the point.
double InFront(const ImagePlane& plane, const ReliablePoint& p) {
  return plane.x() * p.col + plane.y() * p.row + plane.z() - p.inverse_depth;
}

double Residual(const ImagePlane& plane, const ReliablePoint& p) {
  return std::abs(InFront(plane, p));
}

int CountSupport(const ImagePlane& plane,
                 const ReliablePoint* begin,
                 const ReliablePoint* end,
                 double tolerance) {
  int count = 0;
  for (const ReliablePoint* p = begin; p != end; ++p)
    count += Residual(plane, *p) < tolerance;
  return count;
}

int CountSupport(const ImagePlane& plane,
                 const std::vector<ReliablePoint>& points,
                 double tolerance) {
  return CountSupport(
      plane, points.data(), points.data() + points.size(), tolerance);
}

// The same, but gives up, with any number up to `at_least`, where there cannot
// be more.
int CountSupportAbove(const ImagePlane& plane,
                      const std::vector<ReliablePoint>& points,
                      double tolerance,
                      int at_least) {
  constexpr ptrdiff_t kBlock = 64;
  const ReliablePoint* end = points.data() + points.size();
  int count = 0;
  for (const ReliablePoint* p = points.data();
       p != end && count + (end - p) > at_least;) {
    const ReliablePoint* behind = p + std::min(kBlock, end - p);
    count += CountSupport(plane, p, behind, tolerance);
    p = behind;
  }
  return count;
}

bool PlaneThrough(const ReliablePoint& a,
                  const ReliablePoint& b,
                  const ReliablePoint& c,
                  ImagePlane* plane) {
  Eigen::Matrix3d A;
  A << a.col, a.row, 1, b.col, b.row, 1, c.col, c.row, 1;
  if (std::abs(A.determinant()) < 0.5) return false;  // whole pixels: collinear
  *plane = A.inverse() *
           Eigen::Vector3d(a.inverse_depth, b.inverse_depth, c.inverse_depth);
  return true;
}

ImagePlane Refit(const ImagePlane& plane,
                 const std::vector<ReliablePoint>& points,
                 double tolerance) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const ReliablePoint& p : points) {
    if (!(Residual(plane, p) < tolerance)) continue;
    const Eigen::Vector3d x(p.col, p.row, 1);
    A += x * x.transpose();
    b += p.inverse_depth * x;
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(A);
  if (solver.info() != Eigen::Success) return plane;
  const ImagePlane fitted = solver.solve(b);
  return fitted.allFinite() ? fitted : plane;
}

// The plane that most points support, refitted to them.
ImagePlane BestPlane(const std::vector<ReliablePoint>& points,
                     double tolerance,
                     Rng* rng) {
  ImagePlane best = ImagePlane::Zero();
  int best_count = 0;
  const auto draw = [&]() -> const ReliablePoint& {
    return points[static_cast<size_t>(rng->Uniform() *
                                      static_cast<float>(points.size() - 1))];
  };
  for (int i = 0; i < kNumDraws; ++i) {
    const ReliablePoint& a = draw();
    const ReliablePoint& b = draw();
    const ReliablePoint& c = draw();
    ImagePlane plane;
    if (!PlaneThrough(a, b, c, &plane)) continue;
    const int count = CountSupportAbove(plane, points, tolerance, best_count);
    if (count > best_count) {
      best_count = count;
      best = plane;
    }
  }
  for (int i = 0; i < kNumRefits; ++i) best = Refit(best, points, tolerance);
  return best;
}

std::vector<SupportedPlane> FindPlanes(std::vector<ReliablePoint> points,
                                       double tolerance,
                                       Rng* rng) {
  std::vector<SupportedPlane> planes;
  const double min_support =
      std::max<double>(kMinPoints, kMinSupport * points.size());
  while (planes.size() < kMaxPlanes && points.size() >= min_support) {
    SupportedPlane found = {BestPlane(points, tolerance, rng), {}};
    std::vector<ReliablePoint> rest;
    for (const ReliablePoint& p : points) {
      (Residual(found.plane, p) < tolerance ? found.support : rest)
          .push_back(p);
    }
    if (found.support.size() < min_support) break;
    planes.push_back(std::move(found));
    points = std::move(rest);
  }
  return planes;
}

// How densely a plane is supported around each cell: near support decides, far
// support where there is none near.
cv::Mat SupportDensity(const SupportedPlane& plane,
                       int cell,
                       int cell_cols,
                       int cell_rows) {
  cv::Mat count = cv::Mat::zeros(cell_rows, cell_cols, CV_32F);
  for (const ReliablePoint& p : plane.support)
    count.at<float>(p.row / cell, p.col / cell) += 1;
  cv::Mat near, far;
  cv::GaussianBlur(count, near, cv::Size(), kNearCells);
  cv::GaussianBlur(count, far, cv::Size(), kFarCells);
  return near + kFarWeight * far +
         kAnywhereWeight * static_cast<double>(plane.support.size());
}

Plane ToPlane(const Camera& camera, const ImagePlane& plane) {
  const Vec3f scaled = {static_cast<float>(-plane.x() * camera.fx),
                        static_cast<float>(-plane.y() * camera.fy),
                        static_cast<float>(-(plane.z() + plane.x() * camera.cx +
                                             plane.y() * camera.cy))};
  const float norm = Norm(scaled);
  return {(1 / norm) * scaled, 1 / norm};
}

// At most kMaxPoints of them, by a partial Fisher-Yates shuffle.
void Thin(std::vector<ReliablePoint>* points, Rng* rng) {
  for (size_t i = 0; points->size() > kMaxPoints && i < kMaxPoints; ++i) {
    const size_t j =
        i + static_cast<size_t>(rng->Uniform() *
                                static_cast<float>(points->size() - 1 - i));
    std::swap((*points)[i], (*points)[j]);
  }
  points->resize(std::min(points->size(), kMaxPoints));
}

// Standard deviation along the narrower direction, pixels.
double Narrowness(const std::vector<ReliablePoint>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const ReliablePoint& p : points) mean += Eigen::Vector2d(p.col, p.row);
  mean /= static_cast<double>(points.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const ReliablePoint& p : points) {
    const Eigen::Vector2d d = Eigen::Vector2d(p.col, p.row) - mean;
    covariance += d * d.transpose() / static_cast<double>(points.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
      covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

// A rim point belongs to every region that is near.
std::vector<std::vector<ReliablePoint>> RimsOfRegions(
    const WeakRegions& regions, const std::vector<ReliablePoint>& rim) {
  struct Membership {
    size_t point;
    int label;
  };
  constexpr size_t kChunk = 4096;
  const size_t num_chunks = (rim.size() + kChunk - 1) / kChunk;
  std::vector<std::vector<Membership>> of_chunk(num_chunks);
  tbb::parallel_for(size_t{0}, num_chunks, [&](size_t chunk) {
    std::vector<Membership>& members = of_chunk[chunk];
    const size_t end = std::min(rim.size(), (chunk + 1) * kChunk);
    for (size_t i = chunk * kChunk; i < end; ++i) {
      const size_t first = members.size();
      regions.ForEachNear(rim[i].col, rim[i].row, kRimWidth, [&](int label) {
        for (size_t k = first; k < members.size(); ++k) {
          if (members[k].label == label) return;
        }
        members.push_back({i, label});
      });
    }
  });
  std::vector<std::vector<ReliablePoint>> result(regions.num_regions + 1);
  for (const auto& members : of_chunk) {
    for (const Membership& m : members) result[m.label].push_back(rim[m.point]);
  }
  return result;
}

// Pixels by label.
std::vector<int64_t> Areas(const WeakRegions& regions) {
  std::vector<int64_t> areas(regions.num_regions + 1, 0);
  std::mutex mutex;
  regions.ForEachBand([&](const Rows& rows) {
    std::vector<int64_t> of_band(areas.size(), 0);
    const size_t width = regions.width;
    const auto end =
        regions.label.begin() + static_cast<ptrdiff_t>(rows.end * width);
    for (auto at =
             regions.label.begin() + static_cast<ptrdiff_t>(rows.begin * width);
         at != end;) {
      const auto run = at;
      while (at != end && *at == *run) ++at;
      of_band[*run] += at - run;
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (size_t i = 0; i < areas.size(); ++i) areas[i] += of_band[i];
  });
  return areas;
}

}  // namespace

RegionPlanes FindRegionPlanes(const WeakRegions& regions,
                              const Camera& camera,
                              const std::vector<ReliablePoint>& inner,
                              const std::vector<ReliablePoint>& rim,
                              int lattice_step,
                              float tolerance,
                              uint64_t random_key) {
  RegionPlanes result;
  result.cell =
      std::max(1, std::max(regions.width, regions.height) / kCellsPerSide);
  result.cell_cols = (regions.width - 1) / result.cell + 1;
  const int cell_rows = (regions.height - 1) / result.cell + 1;
  result.of_region.resize(regions.num_regions + 1);

  const std::vector<int64_t> areas = Areas(regions);
  std::vector<std::vector<ReliablePoint>> inner_of(regions.num_regions + 1);
  for (const ReliablePoint& point : inner) {
    inner_of[regions.At(point.col, point.row)].push_back(point);
  }
  std::vector<std::vector<ReliablePoint>> rim_of = RimsOfRegions(regions, rim);

  const auto find_in = [&](int label) {
    Rng rng(random_key, label, 0);
    std::vector<ReliablePoint>& inside = inner_of[label];
    std::vector<ReliablePoint>& outside = rim_of[label];
    const auto area = static_cast<double>(areas[label]);
    const double num_lattice = area / (lattice_step * lattice_step);
    const auto num_inside = static_cast<double>(inside.size());
    Thin(&inside, &rng);
    Thin(&outside, &rng);
    const double share_of_point =
        inside.empty()
            ? 0
            : num_inside / static_cast<double>(inside.size()) / num_lattice;
    const auto add = [&](const SupportedPlane& found, bool from_rim) {
      RegionPlane plane = {};
      plane.plane = ToPlane(camera, found.plane);
      plane.from_rim = from_rim;
      plane.inside =
          share_of_point * CountSupport(found.plane, inside, tolerance);
      for (const ReliablePoint& p : outside) {
        const double in_front = InFront(found.plane, p);
        plane.rim_on += std::abs(in_front) < tolerance;
        plane.rim_behind += in_front > 2 * tolerance;
      }
      const auto num_outside =
          std::max(1.0, static_cast<double>(outside.size()));
      plane.rim_on /= num_outside;
      plane.rim_behind /= num_outside;
      if (plane.inside < kMinInside && plane.rim_on < kMinRim) return;
      plane.spread = Narrowness(found.support) / std::sqrt(area);
      const cv::Mat density =
          SupportDensity(found, result.cell, result.cell_cols, cell_rows);
      plane.nearness.assign(density.begin<float>(), density.end<float>());
      result.of_region[label].push_back(std::move(plane));
    };
    for (const SupportedPlane& found : FindPlanes(inside, tolerance, &rng))
      add(found, false);
    for (const SupportedPlane& found : FindPlanes(outside, tolerance, &rng))
      add(found, true);
  };
  tbb::parallel_for(tbb::blocked_range<int>(1, regions.num_regions + 1, 1),
                    [&](const auto& labels) {
                      for (int l = labels.begin(); l < labels.end(); ++l)
                        find_in(l);
                    });
  return result;
}

}  // namespace hpm
