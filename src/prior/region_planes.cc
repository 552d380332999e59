#include "src/prior/region_planes.h"

#include "src/core/rng.h"
#include "src/core/warp.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

namespace hpm {
namespace {

constexpr int kMaxPlanes = 4;
constexpr int kMinPoints = 50;
constexpr double kMinSupport = 0.08;  // share of a region's reliable points
constexpr int kNumDraws = 300;
constexpr int kNumRefits = 3;
constexpr size_t kMaxPoints = 4000;  // used of a region
constexpr int kCellsPerSide = 100;   // of the grid in which support is counted
constexpr double kNearCells = 4, kFarCells = 16;  // blur of the support
constexpr float kFarWeight = 1e-3f, kAnywhereWeight = 1e-6f;

// A plane in the image: 1/z = x . (col, row, 1).
using ImagePlane = Eigen::Vector3d;

struct SupportedPlane {
  ImagePlane plane;
  std::vector<ReliablePoint> support;
};

double Residual(const ImagePlane& plane, const ReliablePoint& p) {
  return std::abs(plane.x() * p.col + plane.y() * p.row + plane.z() -
                  p.inverse_depth);
}

int CountSupport(const ImagePlane& plane,
                 const std::vector<ReliablePoint>& points,
                 double tolerance) {
  int count = 0;
  for (const ReliablePoint& p : points) count += Residual(plane, p) < tolerance;
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
    const int count = CountSupport(plane, points, tolerance);
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

}  // namespace

std::vector<Plane> MakeRegionPlanes(const WeakRegions& regions,
                                    const Camera& camera,
                                    const std::vector<ReliablePoint>& points,
                                    float tolerance,
                                    const PriorRange& range,
                                    uint64_t random_key) {
  const int width = regions.width, height = regions.height;
  std::vector<Plane> result(regions.label.size(), Plane{{0, 0, 0}, 0});
  std::vector<std::vector<ReliablePoint>> of_region(regions.num_regions + 1);
  for (const ReliablePoint& point : points) {
    const int label =
        regions.label[static_cast<size_t>(point.row) * width + point.col];
    if (label > 0) of_region[label].push_back(point);
  }
  const int cell = std::max(1, std::max(width, height) / kCellsPerSide);
  const int cell_cols = (width - 1) / cell + 1;
  const int cell_rows = (height - 1) / cell + 1;
  // Per region: its planes, and in each cell the one of densest support.
  std::vector<std::vector<Plane>> planes(regions.num_regions + 1);
  std::vector<cv::Mat> choice(regions.num_regions + 1);
  for (int label = 1; label <= regions.num_regions; ++label) {
    Rng rng(random_key, label, 0);
    std::vector<ReliablePoint>& own = of_region[label];
    for (size_t i = 0; own.size() > kMaxPoints && i < kMaxPoints; ++i) {
      // Partial Fisher-Yates shuffle.
      const size_t j =
          i + static_cast<size_t>(rng.Uniform() *
                                  static_cast<float>(own.size() - 1 - i));
      std::swap(own[i], own[j]);
    }
    own.resize(std::min(own.size(), kMaxPoints));
    const std::vector<SupportedPlane> found = FindPlanes(own, tolerance, &rng);
    cv::Mat best;
    choice[label] = cv::Mat::zeros(cell_rows, cell_cols, CV_8U);
    for (size_t k = 0; k < found.size(); ++k) {
      planes[label].push_back(ToPlane(camera, found[k].plane));
      const cv::Mat density =
          SupportDensity(found[k], cell, cell_cols, cell_rows);
      if (k == 0) {
        best = density;
        continue;
      }
      choice[label].setTo(static_cast<double>(k), density > best);
      best = cv::max(best, density);
    }
  }
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const size_t at = static_cast<size_t>(row) * width + col;
      const int label = regions.label[at];
      if (planes[label].empty()) continue;
      const Plane& plane =
          planes[label][choice[label].at<uint8_t>(row / cell, col / cell)];
      const float z = DepthAt(
          camera, plane, static_cast<float>(col), static_cast<float>(row));
      if (z >= range.depth_min && z <= range.depth_max) result[at] = plane;
    }
  }
  return result;
}

}  // namespace hpm
