#include "colmap_plugin/options/quality.h"

namespace hpm {
namespace {

Quality MakeQuality(const std::string& name,
                    int num_iterations,
                    int num_geom_passes,
                    int num_fine_iterations,
                    int num_fine_geom_passes) {
  return {name,
          {{"Hpm.num_iterations", std::to_string(num_iterations)},
           {"Hpm.num_geom_passes", std::to_string(num_geom_passes)},
           {"Hpm.num_fine_iterations", std::to_string(num_fine_iterations)},
           {"Hpm.num_fine_geom_passes", std::to_string(num_fine_geom_passes)}}};
}

}  // namespace

// high: each method's own numbers.
const std::vector<Quality>& Qualities() {
  static const std::vector<Quality> qualities = {
      MakeQuality("low", 2, 2, 0, 1),
      MakeQuality("medium", 2, 2, 2, 1),
      {"high", {}},
      MakeQuality("extreme", 3, 4, 7, 2)};
  return qualities;
}

std::vector<std::string> QualityNames() {
  std::vector<std::string> names;
  for (const Quality& quality : Qualities()) names.push_back(quality.name);
  return names;
}

}  // namespace hpm
