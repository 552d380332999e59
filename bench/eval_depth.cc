// Depth and normal maps of a workspace against ground truth: a table and JSON.
#include "bench/eval/depth_eval.h"
#include "bench/eval/json_file.h"
#include "bench/eval/program.h"
#include "src/base/error.h"

#include <iostream>

#include <fmt/format.h>

namespace hpm {
namespace {

nlohmann::json ToJson(const DepthScore& score) {
  return {{"pixels", score.num_pixels},
          {"density", score.density},
          {"within", score.within},
          {"within_estimated", score.within_estimated},
          {"median_relative_error", score.median_relative_error},
          {"median_normal_error_deg", score.median_normal_error}};
}

void PrintRow(const char* name, const DepthScore& score) {
  std::string row = fmt::format(
      "{:<6}{:>9}{:>8.1f}", name, score.num_pixels, 100 * score.density);
  for (const double share : score.within)
    row += fmt::format("{:>7.1f}", 100 * share);
  row += fmt::format("{:>11.3f}{:>10.2f}",
                     100 * score.median_relative_error,
                     score.median_normal_error);
  std::cout << row << "\n";
}

}  // namespace
}  // namespace hpm

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  hpm::DepthEvaluationOptions options;
  std::string workspace, truth, rule, json;
  po::options_description table;
  // clang-format off
  table.add_options()
      ("workspace_path", po::value(&workspace)->required(), "dense workspace (first word)")
      ("truth", po::value(&truth), "folder with depth_maps/ and normal_maps/; default: WORKSPACE/gt")
      ("stage", po::value(&options.stage)->default_value("geometric"), "geometric or photometric")
      ("rule", po::value(&rule)->default_value("colmap"),
       "ray of an estimated pixel: colmap (integer col, row) or center")
      ("low_texture", po::value(&options.low_texture_limit)->default_value(2.0),
       "grey deviation below which a pixel is low-textured")
      ("json", po::value(&json), "also write the figures to this file");
  // clang-format on
  po::positional_options_description positional;
  positional.add("workspace_path", 1);
  return hpm::RunProgram(
      argc,
      argv,
      "Depth and normal maps of a workspace against ground truth.",
      table,
      positional,
      [&](const po::variables_map&) {
        if (rule != "colmap" && rule != "center") {
          throw hpm::Error(hpm::ErrorCode::kUsage,
                           "--rule must be colmap or center");
        }
        options.rule = rule == "colmap" ? hpm::PixelRule::kColmap
                                        : hpm::PixelRule::kCenter;
        options.workspace = workspace;
        options.truth = truth.empty() ? options.workspace / "gt"
                                      : std::filesystem::path(truth);
        const hpm::DepthEvaluation result = hpm::EvaluateDepth(options);
        std::cout << fmt::format(
            "{} images, {} maps missing. Percent of pixels with ground truth "
            "(holes are wrong):\n",
            result.num_images,
            result.num_missing_maps);
        std::cout << "         pixels density   0.1%   0.2%   0.5%     1%     "
                     "2%     5%"
                     "  median err%  normal deg\n";
        hpm::PrintRow("all", result.all);
        hpm::PrintRow("low", result.low_texture);
        hpm::PrintRow("rest", result.rest);
        hpm::PrintRow("edges", result.edges);
        hpm::WriteJsonFile(json,
                           {{"all", hpm::ToJson(result.all)},
                            {"low_texture", hpm::ToJson(result.low_texture)},
                            {"rest", hpm::ToJson(result.rest)},
                            {"edges", hpm::ToJson(result.edges)},
                            {"thresholds", hpm::kDepthThresholds},
                            {"rule", rule},
                            {"stage", options.stage},
                            {"images", result.num_images},
                            {"missing_maps", result.num_missing_maps}});
      });
}
