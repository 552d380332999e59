// Bars of a histogram as SVG.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hpm {

struct BarChart {
  int bar_width;  // pixels, with the gap to the next
  int height;     // of the highest bar
  const char* color;
  const char* low;   // what the left end means; a text below
  const char* high;  // and the right end
  // Of each bar, shown under the pointer; none: one shape for all bars, which
  // is short.
  std::vector<std::string> titles;
};

std::string Svg(const BarChart& chart, const std::vector<double>& values);

}  // namespace hpm
