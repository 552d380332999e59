// A fused cloud against a ground-truth cloud: a table and JSON.
#include "bench/eval/cloud_eval.h"
#include "bench/eval/json_file.h"
#include "bench/eval/ply.h"
#include "bench/eval/program.h"
#include "src/base/error.h"
#include "src/base/platform/numbers.h"

#include <iostream>
#include <sstream>

#include <fmt/format.h>

namespace hpm {
namespace {

std::vector<double> ParseThresholds(const std::string& text) {
  std::vector<double> thresholds;
  std::istringstream items(text);
  std::string item;
  while (std::getline(items, item, ',')) {
    double value = 0;
    const auto [end, error] =
        FromChars(item.data(), item.data() + item.size(), &value);
    if (error != std::errc() || end != item.data() + item.size() ||
        !(value > 0)) {
      throw Error(ErrorCode::kUsage,
                  "--thresholds takes positive numbers with commas between");
    }
    thresholds.push_back(value);
  }
  return thresholds;
}

nlohmann::json ToJson(const CloudEvaluation& result) {
  nlohmann::json scores = nlohmann::json::array();
  for (const CloudScore& s : result.scores) {
    scores.push_back({{"threshold", s.threshold},
                      {"accuracy", s.accuracy},
                      {"completeness", s.completeness},
                      {"f1", s.f1},
                      {"balanced_accuracy", s.balanced_accuracy},
                      {"balanced_completeness", s.balanced_completeness},
                      {"balanced_f1", s.balanced_f1}});
  }
  return {{"points", result.num_points},
          {"truth_points", result.num_truth_points},
          {"accuracy_mean", result.accuracy_mean},
          {"accuracy_median", result.accuracy_median},
          {"completeness_mean", result.completeness_mean},
          {"completeness_median", result.completeness_median},
          {"scores", scores}};
}

void Print(const CloudEvaluation& result) {
  std::cout << fmt::format("{} points, ground truth {}\n",
                           result.num_points,
                           result.num_truth_points)
            << fmt::format(
                   "distance to the truth: median {:.5f}, mean {:.5f}\n",
                   result.accuracy_median,
                   result.accuracy_mean)
            << fmt::format(
                   "distance from the truth: median {:.5f}, mean {:.5f}\n",
                   result.completeness_median,
                   result.completeness_mean)
            << "threshold  accuracy  completeness     F1   balanced: accuracy  "
               "completeness     F1\n";
  for (const CloudScore& s : result.scores) {
    std::cout << fmt::format(
        "{:<9g}{:>10.1f}{:>14.1f}{:>7.1f}{:>21.1f}{:>14.1f}{:>7.1f}\n",
        s.threshold,
        100 * s.accuracy,
        100 * s.completeness,
        100 * s.f1,
        100 * s.balanced_accuracy,
        100 * s.balanced_completeness,
        100 * s.balanced_f1);
  }
}

}  // namespace
}  // namespace hpm

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  std::string estimate, truth, thresholds, json;
  po::options_description table;
  // clang-format off
  table.add_options()
      ("cloud", po::value(&estimate)->required(), "fused PLY (first word)")
      ("truth", po::value(&truth)->required(), "ground-truth PLY (second word)")
      ("thresholds", po::value(&thresholds)->default_value("0.01,0.02,0.05,0.1"), "model units")
      ("json", po::value(&json), "also write the figures to this file");
  // clang-format on
  po::positional_options_description positional;
  positional.add("cloud", 1).add("truth", 1);
  return hpm::RunProgram(
      argc,
      argv,
      "A fused point cloud against a ground-truth cloud.",
      table,
      positional,
      [&](const po::variables_map&) {
        const std::vector<double> values = hpm::ParseThresholds(thresholds);
        const hpm::CloudEvaluation result = hpm::EvaluateCloud(
            hpm::ReadPly(estimate).points, hpm::ReadPly(truth).points, values);
        hpm::Print(result);
        hpm::WriteJsonFile(json, hpm::ToJson(result));
      });
}
