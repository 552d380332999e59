// A libFuzzer program: all SIMD targets of the matching cost and the scalar one
// give the cost that the same formula has in double precision, on any bytes as
// images, camera and planes; as near as float32 sums and positions can be
// there, which is nothing where a window is almost constant. Built and run by
// scripts/fuzz.sh.
#include "src/cpu/cpu_views.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace hpm {
namespace {

constexpr int kWidth = 24, kHeight = 20;
constexpr double kTolerance = 1e-2;  // as tests/cpu/cpu_targets_test.cc
constexpr double kEpsilon = std::numeric_limits<float>::epsilon();

class Bytes {
 public:
  Bytes(const uint8_t* data, size_t size) : data_(data), size_(size) {}
  uint8_t Next() { return at_ < size_ ? data_[at_++] : 0; }
  // In [-1, 1].
  float Share() { return static_cast<float>(Next()) / 127.5f - 1; }

 private:
  const uint8_t* data_;
  size_t size_;
  size_t at_ = 0;
};

struct Input {
  ViewSet views;
  std::vector<Plane> planes;
  int col = 0, row = 0;
};

Input MakeInput(const uint8_t* data, size_t size) {
  Bytes bytes(data, size);
  Input input;
  input.col = bytes.Next() % kWidth;
  input.row = bytes.Next() % kHeight;
  Camera camera = {kWidth,
                   kHeight,
                   30,
                   30,
                   11.5f,
                   9.5f,
                   {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
                   {0, 0, 0}};
  const int num_planes = 1 + bytes.Next() % kNumRegions;
  const int num_srcs = 1 + bytes.Next() % 4;
  std::vector<Camera> cameras = {camera};
  for (int i = 0; i < num_srcs; ++i) {
    const float turn = bytes.Share();
    camera.R = {{std::cos(turn),
                 0,
                 std::sin(turn),
                 0,
                 1,
                 0,
                 -std::sin(turn),
                 0,
                 std::cos(turn)}};
    camera.t = {bytes.Share(), bytes.Share(), bytes.Share()};
    camera.fx = 30 + 15 * bytes.Share();
    cameras.push_back(camera);
  }
  for (int i = 0; i < num_planes; ++i) {
    Vec3f normal = {bytes.Share(), bytes.Share(), -1.001f + bytes.Share()};
    const float length = std::sqrt(Dot(normal, normal));
    normal = {normal.x / length, normal.y / length, normal.z / length};
    input.planes.push_back({normal, 2 + 2 * bytes.Share()});
  }
  const auto image_of = [&](const Camera& at) {
    const auto image =
        std::make_shared<GrayImage>(GrayImage{at.width, at.height, {}});
    for (int i = 0; i < at.width * at.height; ++i)
      image->data.push_back(bytes.Next());
    return image;
  };
  input.views.ref = {cameras[0], image_of(cameras[0]), nullptr};
  for (int i = 1; i <= num_srcs; ++i)
    input.views.srcs.push_back({cameras[i], image_of(cameras[i]), nullptr});
  input.views.depth_min = 0.1f;
  input.views.depth_max = 10;
  return input;
}

struct Expected {
  double cost = 0;
  double bound = 0;
};

// Nothing where rounding decides whether the cost is the maximum.
std::optional<Expected> Exact(const CpuViews& cpu_views,
                              const Input& input,
                              const Plane& plane,
                              int view) {
  const MatchViews& match = cpu_views.match();
  const RefPatch ref = cpu_views.PatchAt(input.col, input.row);
  if (ref.variance < kMinVariance) return Expected{kMaxCost, 0};
  const GrayImage& image = *input.views.srcs[view].image;
  const double inv_d = 1 / static_cast<double>(plane.distance);
  const double slope[2] = {plane.normal.x / match.ref.fx * inv_d,
                           plane.normal.y / match.ref.fy * inv_d};
  const double constant = plane.normal.z * inv_d - slope[0] * match.ref.cx -
                          slope[1] * match.ref.cy;
  const double v[3] = {match.v[0][view], match.v[1][view], match.v[2][view]};
  // As the sums below are made: what they cancel of.
  double largest = 0;
  const auto position = [&](double col, double row, int axis) {
    const double terms[4] = {
        match.M[3 * axis][view] * col,
        match.M[3 * axis + 1][view] * row,
        match.M[3 * axis + 2][view],
        -(slope[0] * col + slope[1] * row + constant) * v[axis]};
    const double sizes =
        std::abs(terms[0]) + std::abs(terms[1]) + std::abs(terms[2]) +
        (std::abs(slope[0] * col) + std::abs(slope[1] * row) +
         std::abs(constant) + std::abs(slope[0] * match.ref.cx) +
         std::abs(slope[1] * match.ref.cy)) *
            std::abs(v[axis]);
    largest = std::max(largest, sizes);
    return terms[0] + terms[1] + terms[2] + terms[3];
  };
  double nearest = std::numeric_limits<double>::infinity(), shift = 0;
  double sum_s = 0, sum_ss = 0, sum_rs = 0, sum_ars = 0, sum_w = 0;
  for (int j = 0; j < kPatchAxis; ++j) {
    for (int i = 0; i < kPatchAxis; ++i) {
      const double col = input.col + match.shape.offset[i],
                   row = input.row + match.shape.offset[j];
      const double z = position(col, row, 2);
      const double u = position(col, row, 0) / z, w = position(col, row, 1) / z;
      nearest = std::min(nearest, z);
      // Positions in pixels, wrong by so much.
      shift = std::max(shift,
                       16 * kEpsilon * largest / std::abs(z) *
                           (1 + std::abs(u) + std::abs(w)));
      const double cu = std::clamp(u, 0., kWidth - 1.),
                   cw = std::clamp(w, 0., kHeight - 1.);
      const int iu = std::min(static_cast<int>(cu), kWidth - 2),
                iw = std::min(static_cast<int>(cw), kHeight - 2);
      const double fu = cu - iu, fw = cw - iw;
      const double s =
          (1 - fw) * ((1 - fu) * image.at(iu, iw) + fu * image.at(iu + 1, iw)) +
          fw * ((1 - fu) * image.at(iu, iw + 1) +
                fu * image.at(iu + 1, iw + 1)) -
          ref.center;
      const int k = j * kPatchAxis + i;
      sum_w += ref.weight[k];
      sum_s += ref.weight[k] * s;
      sum_ss += ref.weight[k] * s * s;
      sum_rs += ref.weighted[k] * s;
      sum_ars += std::abs(ref.weighted[k] * s);
    }
  }
  const double z = position(input.col, input.row, 2);
  const double u = position(input.col, input.row, 0) / z,
               w = position(input.col, input.row, 1) / z;
  if (!(std::abs(nearest) > 64 * kEpsilon * largest) || !std::isfinite(shift))
    return std::nullopt;
  // Invisible by the whole square's nearest corner.
  if (nearest < 0) return Expected{kMaxCost, 0};
  const double inside =
      std::min({u + 0.5, w + 0.5, kWidth - 0.5 - u, kHeight - 0.5 - w});
  if (std::abs(inside) < 4 * shift + 1e-4) return std::nullopt;
  if (inside < 0) return Expected{kMaxCost, 0};
  const double variance = sum_ss - sum_s * sum_s;
  // Of each sample, and of the sums (36 terms).
  const double sample_error = 2 * 255 * shift + 255 * 8 * kEpsilon;
  const double sum_error =
      64 * kEpsilon * (sum_ss + std::abs(1 - sum_w) * sum_ss);
  const double variance_error =
      2 * std::sqrt(std::max(variance, 0.)) * sample_error +
      sample_error * sample_error + sum_error;
  if (variance < kMinVariance - variance_error) return Expected{kMaxCost, 0};
  if (variance < kMinVariance + 4 * variance_error) return std::nullopt;
  const double covariance = sum_rs - ref.mean * sum_s;
  const double scale = std::sqrt(ref.variance * variance);
  const double covariance_error =
      std::sqrt(static_cast<double>(ref.variance)) * sample_error +
      64 * kEpsilon * (sum_ars + std::abs(ref.mean * sum_s));
  const double ncc = covariance / scale;
  return Expected{std::clamp(1 - ncc, 0., double{kMaxCost}),
                  4 * (covariance_error / scale +
                       std::abs(ncc) * variance_error / variance)};
}

void Fail(const CpuTarget& target,
          size_t pair,
          float cost,
          const Expected& expected) {
  std::fprintf(
      stderr,
      "target %s, pair %zu: cost %.7g, in double precision %.7g, bound %.3g\n",
      target.name.c_str(),
      pair,
      static_cast<double>(cost),
      expected.cost,
      expected.bound);
  std::abort();
}

void Check(const Input& input) {
  const CpuViews cpu_views(input.views, MethodParams());
  std::vector<uint8_t> views;
  for (size_t i = 0; i < input.views.srcs.size(); ++i)
    views.push_back(static_cast<uint8_t>(i));
  const size_t num_pairs = input.planes.size() * views.size();
  std::vector<std::optional<Expected>> expected;
  for (const Plane& plane : input.planes) {
    for (const int view : views) {
      expected.push_back(plane.distance > 0
                             ? Exact(cpu_views, input, plane, view)
                             : std::nullopt);
    }
  }
  for (const CpuTarget& target : CpuTargets()) {
    constexpr float kUntouched = -7;
    std::vector<float> costs(num_pairs + 1, kUntouched);
    CpuPixelCost(cpu_views, target, 0, input.col, input.row)
        .Photometric(input.planes.data(),
                     static_cast<int>(input.planes.size()),
                     views.data(),
                     static_cast<int>(views.size()),
                     costs.data());
    if (costs.back() != kUntouched)
      Fail(target, num_pairs, costs.back(), {kUntouched, 0});
    for (size_t i = 0; i < num_pairs; ++i) {
      if (!(costs[i] >= 0 && costs[i] <= kMaxCost))
        Fail(target, i, costs[i], {0, kMaxCost});
      if (expected[i] && !(std::abs(costs[i] - expected[i]->cost) <=
                           kTolerance + expected[i]->bound))
        Fail(target, i, costs[i], *expected[i]);
    }
  }
}

}  // namespace
}  // namespace hpm

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  hpm::Check(hpm::MakeInput(data, size));
  return 0;
}
