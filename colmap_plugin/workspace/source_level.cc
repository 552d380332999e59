#include "colmap_plugin/workspace/source_level.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hpm {
namespace {

// From here on a source is halved. In a rendered room, matching against sources
// of 1.3, 1.5, 1.7 and 2 times the zoom put 5.8, 9.6, 10.0 and 7.9 % more
// pixels within 2 % of the truth when they were halved; sources that differ no
// more than pictures of one camera along a walk do stay as they are.
constexpr double kMinRatio = 1.5;

double FocalRatio(const Camera& ref, const Camera& src) {
  return std::sqrt(static_cast<double>(src.fx) * src.fy /
                   (static_cast<double>(ref.fx) * ref.fy));
}

// Whether SamplingRatio() can reach the bound. On a ray depth / z grows or
// falls with depth, at one depth it does so along rows and columns, as long as
// all lies before the source, so no place exceeds the corners of what is seen.
// Thousands of images have few such sources, and this is 8 places, not 432.
bool CanReach(double bound,
              const Camera& ref,
              const Camera& src,
              float depth_min,
              float depth_max) {
  constexpr double kRounding = 1.001;
  const double focal_ratio = FocalRatio(ref, src);
  for (const int corner : {0, 1, 2, 3}) {
    const Vec3f ray = RayAt(ref,
                            static_cast<float>(ref.width * (corner % 2)),
                            corner < 2 ? 0 : static_cast<float>(ref.height));
    for (const float depth : {depth_min, depth_max}) {
      const float z = CamFromWorld(src, WorldFromCam(ref, depth * ray)).z;
      if (!(z > 0) || focal_ratio * depth / z * kRounding >= bound) return true;
    }
  }
  return false;
}

// The source's pixels per pixel of the reference, in length, on surfaces that
// face the cameras: the median over what both may see, 0 if that is nothing.
double SamplingRatio(const Camera& ref,
                     const Camera& src,
                     float depth_min,
                     float depth_max) {
  constexpr int kNumAcross = 12, kNumDepths = 3;
  const auto middle = [](int step, int count) {
    return (static_cast<float>(step) + 0.5f) / static_cast<float>(count);
  };
  const double focal_ratio = FocalRatio(ref, src);
  // Asked of every source in every stage, so roots are taken once.
  float depths[kNumDepths];
  for (int k = 0; k < kNumDepths; ++k) {
    depths[k] =
        depth_min * std::pow(depth_max / depth_min, middle(k, kNumDepths));
  }
  std::vector<double> ratios;
  ratios.reserve(kNumAcross * kNumAcross * kNumDepths);
  for (int i = 0; i < kNumAcross * kNumAcross * kNumDepths; ++i) {
    const float depth = depths[i / (kNumAcross * kNumAcross)];
    const Vec3f ray = RayAt(
        ref,
        static_cast<float>(ref.width) * middle(i % kNumAcross, kNumAcross),
        static_cast<float>(ref.height) *
            middle(i / kNumAcross % kNumAcross, kNumAcross));
    const Vec3f point = CamFromWorld(src, WorldFromCam(ref, depth * ray));
    if (!(point.z > 0)) continue;
    const float col = src.fx * point.x / point.z + src.cx;
    const float row = src.fy * point.y / point.z + src.cy;
    if (col >= 0 && row >= 0 && col < static_cast<float>(src.width) &&
        row < static_cast<float>(src.height)) {
      ratios.push_back(focal_ratio * depth / point.z);
    }
  }
  if (ratios.empty()) return 0;
  const auto median =
      ratios.begin() + static_cast<ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), median, ratios.end());
  return *median;
}

}  // namespace

int SourceLevel(const Workspace& workspace,
                const StereoProblem& problem,
                int src_image) {
  // Windows of fewer pixels across than this are no images any more.
  constexpr int kMinSide = 16;
  const Camera ref =
      workspace.CameraAround(problem.ref_image, problem.ref_image);
  const Camera src = workspace.CameraAround(src_image, problem.ref_image);
  if (!CanReach(kMinRatio, ref, src, problem.depth_min, problem.depth_max))
    return 0;
  double ratio = SamplingRatio(ref, src, problem.depth_min, problem.depth_max);
  int level = 0;
  while (ratio >= kMinRatio &&
         std::min(src.width, src.height) >> (level + 1) >= kMinSide) {
    ratio /= 2;
    ++level;
  }
  return level;
}

}  // namespace hpm
