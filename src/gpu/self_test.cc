#include "src/gpu/self_test.h"

#include "src/core/sampling_pattern.h"

#include <cmath>
#include <string>

namespace hpm {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;
constexpr int kNumSrcs = 4;

// The plane Z = kDepth + kSlope * X of the world, which is the frame of the
// reference camera.
constexpr float kDepth = 5;
constexpr float kSlope = 0.25f;

// Pixels so close to the border are not judged: some sources do not see them.
constexpr int kMargin = 10;

// Share of the others that must be within 1 % of the truth.
constexpr double kMinGoodShare = 0.9;

Camera CameraAt(float x, float y) {
  Camera camera = {};
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 90;
  camera.cx = 0.5f * (kWidth - 1);
  camera.cy = 0.5f * (kHeight - 1);
  camera.R = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  camera.t = {-x, -y, 0};
  return camera;
}

// Depth where the ray of a pixel of a camera at `center` meets the plane.
float TrueDepth(const Camera& camera, const Vec3f& center, int col, int row) {
  const Vec3f ray =
      RayAt(camera, static_cast<float>(col), static_cast<float>(row));
  return (kDepth + kSlope * center.x - center.z) / (1 - kSlope * ray.x);
}

// Waves on the plane; the longest and the shortest are 20 and 6 pixels.
float GreyAt(float x, float y) {
  const float f = 6.28318531f;
  return 128 + 30 * std::sin(f * (1.1f * x + 0.7f * y)) +
         25 * std::sin(f * (-0.9f * x + 1.6f * y) + 1) +
         20 * std::sin(f * (2.3f * x + 1.9f * y) + 2) +
         20 * std::sin(f * (2.1f * x - 1.4f * y) + 3);
}

View ViewAt(float x, float y) {
  View view;
  view.camera = CameraAt(x, y);
  GrayImage image{kWidth, kHeight, {}};
  const Vec3f center = Center(view.camera);
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const float z = TrueDepth(view.camera, center, col, row);
      const Vec3f point = WorldFromCam(view.camera,
                                       z * RayAt(view.camera,
                                                 static_cast<float>(col),
                                                 static_cast<float>(row)));
      const float grey = Clamp(GreyAt(point.x, point.y), 0.0f, 255.0f) + 0.5f;
      image.data.push_back(static_cast<uint8_t>(grey));
    }
  }
  view.image = std::make_shared<const GrayImage>(std::move(image));
  return view;
}

}  // namespace

std::string SelfTestFailure(Backend* backend) {
  ViewSet views;
  views.ref = ViewAt(0, 0);
  for (int j = 0; j < kNumSrcs; ++j) {
    views.srcs.push_back(
        ViewAt(j % 2 == 0 ? -0.5f : 0.5f, j < 2 ? -0.3f : 0.3f));
  }
  views.depth_min = 0.6f * kDepth;
  views.depth_max = 1.6f * kDepth;
  views.random_key = 1;
  const CancelToken cancel;
  const RunControl control = {&cancel, nullptr};
  HypothesisMap map(kWidth, kHeight);
  try {
    backend->SetViews(views, MethodParams());
    backend->Run({PassKind::kBasic, StartFrom::kRandom, 4, 0},
                 MakeSamplingPattern(true, true),
                 &map,
                 control);
  } catch (const Error& error) {
    return error.what();
  }
  int num_good = 0, num_judged = 0;
  for (int row = kMargin; row < kHeight - kMargin; ++row) {
    for (int col = kMargin; col < kWidth - kMargin; ++col) {
      const size_t at = static_cast<size_t>(row) * kWidth + col;
      const float truth = TrueDepth(views.ref.camera, {0, 0, 0}, col, row);
      const float depth = DepthAt(views.ref.camera,
                                  map.planes[at],
                                  static_cast<float>(col),
                                  static_cast<float>(row));
      ++num_judged;
      num_good += std::abs(depth - truth) <= 0.01f * truth;
    }
  }
  const double share = num_good / static_cast<double>(num_judged);
  if (share >= kMinGoodShare) return "";
  const auto percent = [](double part) {
    return std::to_string(static_cast<int>(100 * part)) + " %";
  };
  return "the self-test found " + percent(share) + " of a plane, " +
         percent(kMinGoodShare) + " are needed";
}

}  // namespace hpm
