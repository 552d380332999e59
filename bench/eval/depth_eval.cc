#include "bench/eval/depth_eval.h"

#include "bench/eval/model_camera.h"
#include "bench/eval/statistics.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/formats/sparse_model.h"
#include "src/base/error.h"
#include "src/core/plane.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hpm {
namespace {

// Collects pixels of one kind (all, low-textured, rest).
class Tally {
 public:
  // `estimate` <= 0: none. `normal_error` in degrees, negative: none.
  void Add(float estimate, float truth, float normal_error) {
    ++num_pixels_;
    if (estimate > 0)
      relative_errors_.push_back(std::abs(estimate - truth) / truth);
    if (normal_error >= 0) normal_errors_.push_back(normal_error);
  }

  DepthScore Score() const {
    DepthScore score;
    score.num_pixels = num_pixels_;
    const auto share = [](size_t part, size_t whole) {
      return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole)
                       : 0.0;
    };
    score.density = share(relative_errors_.size(), num_pixels_);
    for (size_t i = 0; i < kDepthThresholds.size(); ++i) {
      const auto right = static_cast<size_t>(std::count_if(
          relative_errors_.begin(), relative_errors_.end(), [i](float error) {
            return error < kDepthThresholds[i];
          }));
      score.within[i] = share(right, num_pixels_);
      score.within_estimated[i] = share(right, relative_errors_.size());
    }
    score.median_relative_error = Median(relative_errors_);
    score.median_normal_error = Median(normal_errors_);
    return score;
  }

 private:
  size_t num_pixels_ = 0;
  std::vector<float> relative_errors_;
  std::vector<float> normal_errors_;
};

std::optional<Map> ReadIfThere(const std::filesystem::path& path,
                               int channels) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  Map map = ReadMap(path);
  if (map.channels != channels) {
    throw Error(ErrorCode::kBadInput,
                path.string() + ": has " + std::to_string(map.channels) +
                    " channels, not " + std::to_string(channels));
  }
  return map;
}

void CheckSize(const std::filesystem::path& path,
               const Map& map,
               const Map& truth) {
  if (map.width == truth.width && map.height == truth.height) return;
  throw Error(ErrorCode::kBadInput,
              path.string() + ": is " + std::to_string(map.width) + "x" +
                  std::to_string(map.height) + ", its ground truth " +
                  std::to_string(truth.width) + "x" +
                  std::to_string(truth.height));
}

// Standard deviation of grey values in an 11x11 window below the limit; a 3x3
// mean first takes off sensor noise.
cv::Mat LowTextureMask(const std::filesystem::path& path,
                       double limit,
                       const Map& truth) {
  const cv::Mat grey = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
  if (grey.empty())
    throw Error(ErrorCode::kBadInput, path.string() + ": cannot be read");
  if (grey.cols != truth.width || grey.rows != truth.height) {
    throw Error(ErrorCode::kBadInput,
                path.string() + ": has another size than its ground truth");
  }
  cv::Mat smooth, mean, mean_of_squares;
  grey.convertTo(smooth, CV_32F);
  cv::blur(smooth, smooth, cv::Size(3, 3));
  cv::blur(smooth, mean, cv::Size(11, 11));
  cv::blur(smooth.mul(smooth), mean_of_squares, cv::Size(11, 11));
  cv::Mat variance = mean_of_squares - mean.mul(mean);
  return variance < limit * limit;
}

// Pixels at most 3 pixels from where neighbouring true depths differ by 5 %.
cv::Mat EdgeMask(const Map& truth) {
  constexpr float kStep = 1.05f;
  cv::Mat edges(truth.height, truth.width, CV_8U, cv::Scalar(0));
  const auto mark = [&](int col, int row, int other_col, int other_row) {
    if (other_col >= truth.width || other_row >= truth.height) return;
    const size_t width = static_cast<size_t>(truth.width);
    const float a = truth.data[row * width + col];
    const float b = truth.data[other_row * width + other_col];
    if (!(a > 0) || !(b > 0) || (a < kStep * b && b < kStep * a)) return;
    edges.at<uint8_t>(row, col) = edges.at<uint8_t>(other_row, other_col) = 1;
  };
  for (int row = 0; row < truth.height; ++row) {
    for (int col = 0; col < truth.width; ++col) {
      mark(col, row, col + 1, row);
      mark(col, row, col, row + 1);
    }
  }
  cv::dilate(
      edges, edges, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(5, 5)));
  return edges;
}

Vec3f NormalAt(const Map& normals, int col, int row) {
  const size_t plane = static_cast<size_t>(normals.width) * normals.height;
  const size_t at = static_cast<size_t>(row) * normals.width + col;
  return {
      normals.data[at], normals.data[plane + at], normals.data[2 * plane + at]};
}

// Depth that the estimate's own plane has at the pixel centre; unchanged where
// it has no normal or the normal cannot belong to a surface seen along both
// rays.
float DepthAtCenter(
    const Camera& camera, int col, int row, float depth, const Vec3f& normal) {
  const auto x = static_cast<float>(col);
  const auto y = static_cast<float>(row);
  if (!(Dot(normal, RayAt(camera, x, y)) < 0) ||
      !(Dot(normal, RayAt(camera, x + 0.5f, y + 0.5f)) < 0)) {
    return depth;
  }
  return DepthAt(
      camera, PlaneFromDepth(camera, x, y, depth, normal), x + 0.5f, y + 0.5f);
}

float AngleInDegrees(const Vec3f& a, const Vec3f& b) {
  const float lengths = Norm(a) * Norm(b);
  if (!(lengths > 0)) return -1;
  return std::acos(Clamp(Dot(a, b) / lengths, -1.0f, 1.0f)) * 57.29577951f;
}

}  // namespace

DepthEvaluation EvaluateDepth(const DepthEvaluationOptions& options) {
  const SparseModel model = ReadSparseModel(options.workspace / "sparse");
  DepthEvaluation result;
  Tally all, low, rest, edges;
  for (const SparseImage& image : model.images) {
    const std::filesystem::path truth_path =
        options.truth / "depth_maps" / (image.name + ".bin");
    const std::optional<Map> truth = ReadIfThere(truth_path, 1);
    if (!truth) continue;
    ++result.num_images;
    const std::optional<Map> true_normals =
        ReadIfThere(options.truth / "normal_maps" / (image.name + ".bin"), 3);
    if (true_normals) CheckSize(truth_path, *true_normals, *truth);

    const std::string map_name = image.name + "." + options.stage + ".bin";
    const std::filesystem::path depth_path =
        options.workspace / "stereo" / "depth_maps" / map_name;
    const std::filesystem::path normal_path =
        options.workspace / "stereo" / "normal_maps" / map_name;
    const std::optional<Map> depth = ReadIfThere(depth_path, 1);
    const std::optional<Map> normals = ReadIfThere(normal_path, 3);
    if (!depth) ++result.num_missing_maps;
    if (depth) CheckSize(depth_path, *depth, *truth);
    if (normals) CheckSize(normal_path, *normals, *truth);

    const cv::Mat low_texture =
        LowTextureMask(options.workspace / "images" / image.name,
                       options.low_texture_limit,
                       *truth);
    const cv::Mat near_edge = EdgeMask(*truth);
    const Camera camera =
        ModelCamera(model, image, truth->width, truth->height);
    for (int row = 0; row < truth->height; ++row) {
      for (int col = 0; col < truth->width; ++col) {
        const size_t at = static_cast<size_t>(row) * truth->width + col;
        const float true_depth = truth->data[at];
        if (!std::isfinite(true_depth) || true_depth <= 0) continue;
        float estimate = depth ? depth->data[at] : 0;
        if (!std::isfinite(estimate)) estimate = 0;
        float normal_error = -1;
        if (estimate > 0 && normals) {
          const Vec3f normal = NormalAt(*normals, col, row);
          if (true_normals)
            normal_error =
                AngleInDegrees(normal, NormalAt(*true_normals, col, row));
          if (options.rule == PixelRule::kColmap) {
            estimate = DepthAtCenter(camera, col, row, estimate, normal);
          }
        }
        all.Add(estimate, true_depth, normal_error);
        Tally& part = low_texture.at<uint8_t>(row, col) != 0 ? low : rest;
        part.Add(estimate, true_depth, normal_error);
        if (near_edge.at<uint8_t>(row, col) != 0)
          edges.Add(estimate, true_depth, normal_error);
      }
    }
  }
  if (result.num_images == 0) {
    throw Error(ErrorCode::kBadInput,
                options.truth.string() +
                    ": no depth_maps/<image name>.bin of this workspace");
  }
  result.all = all.Score();
  result.low_texture = low.Score();
  result.rest = rest.Score();
  result.edges = edges.Score();
  return result;
}

}  // namespace hpm
