// Depth and normal maps of a workspace against ground truth, over all images.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace hpm {

// To which ray the estimated depth at (row, col) belongs, K being the sparse
// model's (pixel centres at +0.5). Ground truth always lies at pixel centres.
enum class PixelRule {
  kColmap,  // K^-1 (col, row, 1): carried to the pixel centre along the
            // estimate's own plane
  kCenter,  // K^-1 (col + 0.5, row + 0.5, 1)
};

// Relative depth errors below which a pixel counts as right.
inline constexpr std::array<double, 6> kDepthThresholds = {
    0.001, 0.002, 0.005, 0.01, 0.02, 0.05};

struct DepthScore {
  size_t num_pixels = 0;  // with ground truth
  double density = 0;     // share with an estimate, 0..1
  // Share within kDepthThresholds, 0..1: of all pixels (a hole is wrong), of
  // the estimated ones.
  std::array<double, 6> within = {};
  std::array<double, 6> within_estimated = {};
  double median_relative_error = 0;  // of estimated pixels; NaN for none
  double median_normal_error = 0;    // degrees; NaN for none
};

struct DepthEvaluation {
  DepthScore all;
  DepthScore low_texture;  // grey deviation below the limit in an 11x11 window
  DepthScore rest;
  DepthScore edges;  // within 3 pixels of a step of the truth by 5 %
  int num_images = 0;
  int num_missing_maps = 0;  // count as empty
};

struct DepthEvaluationOptions {
  std::filesystem::path workspace;  // holds images/, sparse/ and stereo/
  // Holds depth_maps/ and normal_maps/ with <image name>.bin in COLMAP's
  // layout.
  std::filesystem::path truth;
  std::string stage = "geometric";
  PixelRule rule = PixelRule::kColmap;
  double low_texture_limit = 2.0;  // grey values of 255
};

// Throws Error(kBadInput) if no ground truth is found or a map has another size
// than its ground truth.
DepthEvaluation EvaluateDepth(const DepthEvaluationOptions& options);

}  // namespace hpm
