// The scalar cost over packed texels against the textbook formula in double
// precision over the plain images.
#include "src/cpu/cpu_views.h"

#include "tests/cpu/scene_views.h"

#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace hpm {
namespace {

SceneOptions Options() {
  SceneOptions options;
  options.num_views = 4;
  options.width = 60;
  options.height = 44;
  options.quarter_turns = {0, 1, 2};
  return options;
}

double Bilinear(const GrayImage& image, double u, double v) {
  u = std::clamp(u, 0.0, image.width - 1.0);
  v = std::clamp(v, 0.0, image.height - 1.0);
  const int col = static_cast<int>(u), row = static_cast<int>(v);
  const int right = std::min(col + 1, image.width - 1);
  const int below = std::min(row + 1, image.height - 1);
  const double fu = u - col, fv = v - row;
  return (1 - fv) *
             ((1 - fu) * image.at(col, row) + fu * image.at(right, row)) +
         fv * ((1 - fu) * image.at(col, below) + fu * image.at(right, below));
}

// ACMH's bilaterally weighted NCC in double, word by word, for a pixel whose
// window is seen completely.
double TextbookCost(
    const View& ref, const View& src, const Plane& plane, int col, int row) {
  const auto to_double = [](const Vec3f& v) {
    return Eigen::Vector3d(v.x, v.y, v.z);
  };
  const auto grey_at = [&](int c, int r) -> double {
    return ref.image->at(std::clamp(c, 0, ref.image->width - 1),
                         std::clamp(r, 0, ref.image->height - 1));
  };
  int num_like = 0;
  for (int dy = -5; dy <= 5; dy += 2) {
    for (int dx = -5; dx <= 5; dx += 2)
      num_like +=
          std::abs(grey_at(col + dx, row + dy) - grey_at(col, row)) < 15;
  }
  const double cut = num_like < 12 ? 18.75 : 15;
  double sw = 0, sr = 0, ss = 0, srr = 0, sss = 0, srs = 0;
  for (int dy = -5; dy <= 5; dy += 2) {
    for (int dx = -5; dx <= 5; dx += 2) {
      const int c = col + dx, r = row + dy;
      const double grey = grey_at(c, r);
      const double w =
          std::exp(-std::hypot(dx, dy) / 50 -
                   std::abs(grey - ref.image->at(col, row)) / 18.0 -
                   std::pow((grey - ref.image->at(col, row)) / cut, 2) / 2);
      const Eigen::Vector3d ray((c - ref.camera.cx) / ref.camera.fx,
                                (r - ref.camera.cy) / ref.camera.fy,
                                1);
      const Eigen::Vector3d point =
          -plane.distance / to_double(plane.normal).dot(ray) * ray;
      const Vec3f in_src =
          CamFromWorld(src.camera,
                       WorldFromCam(ref.camera,
                                    {static_cast<float>(point.x()),
                                     static_cast<float>(point.y()),
                                     static_cast<float>(point.z())}));
      const double s =
          Bilinear(*src.image,
                   src.camera.fx * in_src.x / in_src.z + src.camera.cx,
                   src.camera.fy * in_src.y / in_src.z + src.camera.cy);
      sw += w, sr += w * grey, ss += w * s;
      srr += w * grey * grey, sss += w * s * s, srs += w * grey * s;
    }
  }
  const double var_r = srr / sw - sr * sr / sw / sw;
  const double var_s = sss / sw - ss * ss / sw / sw;
  return 1 - (srs / sw - sr * ss / sw / sw) / std::sqrt(var_r * var_s);
}

TEST(CpuPixelCost, ScalarCostIsTheTextbookFormula) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("tilted_plane", Options()), 1);
  const ViewSet set = AsViewSet(rendered);
  MethodParams params;
  params.cut_color = 15;
  const CpuViews cpu_views(set, params);
  std::mt19937 random(5);
  int num_checked = 0;
  for (int row = 0; row < 44; row += 4) {
    for (int col = 0; col < 60; col += 4) {
      const CpuPixelCost cost(cpu_views, FindCpuTarget("scalar"), 5, col, row);
      const size_t at = static_cast<size_t>(row) * 60 + col;
      const float slip = 1 + 0.0002f * static_cast<float>(random() % 100);
      const Plane plane = PlaneFromDepth(set.ref.camera,
                                         static_cast<float>(col),
                                         static_cast<float>(row),
                                         slip * rendered[0].truth.depth[at],
                                         rendered[0].truth.normals[at]);
      const uint8_t views[] = {2, 0, 1};
      float costs[3];
      cost.Photometric(&plane, 1, views, 3, costs);
      EXPECT_EQ(cost.num_evaluations(), 3u);
      for (int k = 0; k < 3; ++k) {
        if (costs[k] == kMaxCost) continue;
        EXPECT_NEAR(costs[k],
                    TextbookCost(set.ref, set.srcs[views[k]], plane, col, row),
                    1e-3);
        ++num_checked;
      }
    }
  }
  EXPECT_GT(num_checked, 300);
}

TEST(CpuPixelCost, TruthIsCheapAndErrorsAreNot) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("tilted_plane", Options()), 4);
  const CpuViews cpu_views(AsViewSet(rendered), MethodParams());
  const int col = 30, row = 22;
  const CpuPixelCost cost(cpu_views, FindCpuTarget("auto"), 5, col, row);
  const size_t at = static_cast<size_t>(row) * 60 + col;
  Plane planes[2];
  for (int i = 0; i < 2; ++i) {
    planes[i] =
        PlaneFromDepth(rendered[0].camera,
                       col,
                       row,
                       (i == 0 ? 1 : 1.1f) * rendered[0].truth.depth[at],
                       rendered[0].truth.normals[at]);
  }
  const uint8_t view = 0;
  float costs[2];
  cost.Photometric(planes, 2, &view, 1, costs);
  EXPECT_LT(costs[0], 0.03);
  EXPECT_GT(costs[1], 0.3);
}

TEST(CpuPixelCost, GeometricErrorIsThatOfTheSourcesDepth) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("tilted_plane", Options()), 1);
  ViewSet set = AsViewSet(rendered);
  std::vector<float> inverse;
  for (const float z : rendered[1].truth.depth) inverse.push_back(1 / z);
  set.srcs[0].inverse_depth =
      std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
  set.srcs[1].inverse_depth = std::make_shared<const InverseDepthMap>(
      InverseDepthMap::Of(std::vector<float>(60 * 44, 0.0f)));
  const CpuViews cpu_views(set, MethodParams());
  const CpuPixelCost cost(cpu_views, FindCpuTarget("auto"), 5, 30, 22);
  const size_t at = 22 * 60 + 30;
  const Plane truth = PlaneFromDepth(rendered[0].camera,
                                     30,
                                     22,
                                     rendered[0].truth.depth[at],
                                     rendered[0].truth.normals[at]);
  Plane off = truth;
  off.distance *= 1.05f;
  const Plane planes[] = {truth, off};
  const uint8_t asked[] = {0, 1, 2};
  float errors[2][3];
  cost.GeometricErrors(planes, 2, asked, 3, errors[0]);
  EXPECT_LT(errors[0][0], 1e-2);
  EXPECT_GT(errors[1][0], 0.1);
  // A map without depth here speaks against the hypothesis; a view without a
  // map has no say.
  EXPECT_EQ(errors[0][1], 5);
  EXPECT_EQ(errors[0][2], 0);
}

}  // namespace
}  // namespace hpm
