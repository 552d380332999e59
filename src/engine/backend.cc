#include "src/engine/backend.h"

#include "src/base/large_vectors.h"

namespace hpm {

std::vector<float> Backend::Score(const std::vector<PixelPlane>& planes,
                                  int width,
                                  int height,
                                  const RunControl& control) {
  const auto pixel_of = [&](size_t i) {
    return static_cast<size_t>(planes[i].row) * width + planes[i].col;
  };
  // A map holds one plane of a pixel: the first planes of all pixels go into
  // the first map, their second ones into the next.
  std::vector<std::vector<size_t>> of_map;
  std::vector<uint16_t> num_planes =
      Filled(static_cast<size_t>(width) * height, uint16_t{0});
  for (size_t i = 0; i < planes.size(); ++i) {
    const size_t nth = num_planes[pixel_of(i)]++;
    if (nth == of_map.size()) of_map.emplace_back();
    of_map[nth].push_back(i);
  }
  num_planes = {};
  std::vector<float> costs(planes.size());
  HypothesisMap map;
  if (!of_map.empty()) {
    const size_t size = static_cast<size_t>(width) * height;
    map.width = width;
    map.height = height;
    map.planes = Filled(size, Plane{{0, 0, 0}, 0});
    map.costs = Filled(size, kMaxCost);
    map.masks = Filled(size, uint32_t{0});
  }
  for (const std::vector<size_t>& indices : of_map) {
    for (const size_t i : indices) map.planes[pixel_of(i)] = planes[i].plane;
    Run({PassKind::kBasic, StartFrom::kScore, 0, 0, 0, false},
        {},
        &map,
        control);
    for (const size_t i : indices) {
      costs[i] = map.costs[pixel_of(i)];
      map.planes[pixel_of(i)].distance = 0;
    }
  }
  return costs;
}

}  // namespace hpm
