#include "colmap_plugin/tool/quality.h"

namespace hpm {
namespace {

Quality MakeQuality(const std::string& name,
                    int num_iterations,
                    int num_geom_passes,
                    int num_geom_iterations,
                    int max_views) {
  return {name,
          {{"Hpm.num_iterations", std::to_string(num_iterations)},
           {"Hpm.num_geom_passes", std::to_string(num_geom_passes)},
           {"Hpm.num_geom_iterations", std::to_string(num_geom_iterations)},
           {"Hpm.max_views", std::to_string(max_views)}}};
}

}  // namespace

const std::vector<Quality>& Qualities() {
  static const std::vector<Quality> qualities = {
      MakeQuality("low", 2, 1, 1, 3),
      MakeQuality("medium", 2, 1, 2, 4),
      MakeQuality("high", 3, 2, 2, 4),
      MakeQuality("extreme", 4, 3, 3, 4)};
  return qualities;
}

std::vector<std::string> QualityNames() {
  std::vector<std::string> names;
  for (const Quality& quality : Qualities()) names.push_back(quality.name);
  return names;
}

}  // namespace hpm
