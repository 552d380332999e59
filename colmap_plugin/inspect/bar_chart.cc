#include "colmap_plugin/inspect/bar_chart.h"

#include "colmap_plugin/inspect/html.h"

#include <algorithm>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr int kTextHeight = 16;

std::string Bars(const BarChart& chart, const std::vector<double>& heights) {
  const int gap = chart.bar_width > 8 ? 2 : 1;
  if (chart.titles.empty()) {
    std::string path;
    for (size_t i = 0; i < heights.size(); ++i) {
      if (!(heights[i] > 0)) continue;
      path += fmt::format("M{} {}v{:.1f}h{}V{}z",
                          i * chart.bar_width,
                          chart.height,
                          -heights[i],
                          chart.bar_width - gap,
                          chart.height);
    }
    return fmt::format("<path fill=\"{}\" d=\"{}\"/>", chart.color, path);
  }
  std::string bars;
  for (size_t i = 0; i < heights.size(); ++i) {
    bars += fmt::format(
        "<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" "
        "fill=\"{}\"><title>{}</title></rect>",
        i * chart.bar_width,
        chart.height - heights[i],
        chart.bar_width - gap,
        heights[i],
        chart.color,
        Html(chart.titles[i]));
  }
  return bars;
}

}  // namespace

std::string Svg(const BarChart& chart, const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, value);
  std::vector<double> heights;
  heights.reserve(values.size());
  for (const double value : values)
    heights.push_back(most > 0 ? chart.height * value / most : 0);
  return fmt::format(
      "<svg width=\"{0}\" height=\"{1}\" role=\"img\">{2}<text x=\"0\" "
      "y=\"{3}\">{4}</text><text x=\"{0}\" y=\"{3}\" "
      "text-anchor=\"end\">{5}</text></svg>",
      values.size() * chart.bar_width,
      chart.height + kTextHeight,
      Bars(chart, heights),
      chart.height + kTextHeight - 2,
      Html(chart.low),
      Html(chart.high));
}

}  // namespace hpm
