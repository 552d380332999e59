#include "colmap_plugin/controller/ray_convention.h"

#include "src/base/error.h"

#include <cmath>

namespace hpm {
namespace {

// Where COLMAP's ray of (col, row) meets the library's pixel grid.
constexpr float kColmapShift = -0.5f;

}  // namespace

DepthAndNormal ToColmapMaps(const HypothesisMap& map,
                            const Camera& camera,
                            const std::vector<bool>* keep) {
  const size_t size = map.planes.size();
  DepthAndNormal out;
  out.depth = {map.width, map.height, 1, std::vector<float>(size, 0.0f)};
  out.normal = {map.width, map.height, 3, std::vector<float>(3 * size, 0.0f)};
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const size_t i = static_cast<size_t>(row) * map.width + col;
      const Plane& plane = map.planes[i];
      if (!(plane.distance > 0) || (keep != nullptr && !(*keep)[i])) continue;
      const float z = DepthAt(camera,
                              plane,
                              static_cast<float>(col) + kColmapShift,
                              static_cast<float>(row) + kColmapShift);
      if (!std::isfinite(z) || !(z > 0)) continue;
      out.depth.data[i] = z;
      out.normal.data[i] = plane.normal.x;
      out.normal.data[size + i] = plane.normal.y;
      out.normal.data[2 * size + i] = plane.normal.z;
    }
  }
  return out;
}

HypothesisMap FromColmapMaps(const Map& depth,
                             const Map& normal,
                             const Camera& camera) {
  HypothesisMap map(camera.width, camera.height);
  const size_t size = map.planes.size();
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const size_t i = static_cast<size_t>(row) * map.width + col;
      if (!(depth.data[i] > 0)) continue;
      const Plane plane = PlaneFromDepth(
          camera,
          static_cast<float>(col) + kColmapShift,
          static_cast<float>(row) + kColmapShift,
          depth.data[i],
          {normal.data[i], normal.data[size + i], normal.data[2 * size + i]});
      const float z = DepthAt(
          camera, plane, static_cast<float>(col), static_cast<float>(row));
      if (std::isfinite(z) && z > 0 && plane.distance > 0)
        map.planes[i] = plane;
    }
  }
  return map;
}

HypothesisMap ReadHypotheses(const std::filesystem::path& depth_path,
                             const std::filesystem::path& normal_path,
                             const Camera& camera) {
  const auto read = [&](const std::filesystem::path& path, int channels) {
    Map map = ReadMap(path);
    if (map.width != camera.width || map.height != camera.height ||
        map.channels != channels) {
      throw Error(ErrorCode::kBadInput,
                  path.string() +
                      ": not the size of its image; delete it and run again");
    }
    return map;
  };
  const Map depth = read(depth_path, 1);
  const Map normal = read(normal_path, 3);
  return FromColmapMaps(depth, normal, camera);
}

}  // namespace hpm
