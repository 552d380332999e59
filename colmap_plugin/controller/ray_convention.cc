#include "colmap_plugin/controller/ray_convention.h"

#include "src/base/error.h"

#include <algorithm>
#include <cmath>

namespace hpm {
namespace {

// Where COLMAP's ray of (col, row) meets the library's pixel grid.
constexpr float kColmapShift = -0.5f;

struct MapPair {
  const Map& depth;
  const Map& normal;
};

// visit(i, plane, z) for every pixel with a depth; z is that of the plane at
// the pixel's centre.
template <class Visit>
void ForEachPlane(const MapPair& maps,
                  const Camera& camera,
                  const Visit& visit) {
  const std::vector<float>& normal = maps.normal.data;
  const size_t size = maps.depth.data.size();
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const size_t i = static_cast<size_t>(row) * camera.width + col;
      const float depth = maps.depth.data[i];
      if (!(depth > 0)) continue;
      const Plane plane =
          PlaneFromDepth(camera,
                         static_cast<float>(col) + kColmapShift,
                         static_cast<float>(row) + kColmapShift,
                         depth,
                         {normal[i], normal[size + i], normal[2 * size + i]});
      const float z = DepthAt(
          camera, plane, static_cast<float>(col), static_cast<float>(row));
      if (std::isfinite(z) && z > 0 && plane.distance > 0) visit(i, plane, z);
    }
  }
}

DepthAndNormal ReadMaps(const std::filesystem::path& depth_path,
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
  return {read(depth_path, 1), read(normal_path, 3)};
}

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

size_t DropOutside(const DepthRange& range, DepthAndNormal* maps) {
  const size_t size = maps->depth.data.size();
  size_t num_dropped = 0;
  for (size_t i = 0; i < size; ++i) {
    const float depth = maps->depth.data[i];
    if (depth == 0 || (depth >= range.min && depth <= range.max)) continue;
    ++num_dropped;
    maps->depth.data[i] = 0;
    for (size_t axis = 0; axis < 3; ++axis)
      maps->normal.data[axis * size + i] = 0;
  }
  return num_dropped;
}

HypothesisMap FromColmapMaps(const Map& depth,
                             const Map& normal,
                             const Camera& camera) {
  HypothesisMap map(camera.width, camera.height);
  ForEachPlane(
      {depth, normal}, camera, [&](size_t i, const Plane& plane, float) {
        map.planes[i] = plane;
      });
  return map;
}

HypothesisMap ReadHypotheses(const std::filesystem::path& depth_path,
                             const std::filesystem::path& normal_path,
                             const Camera& camera) {
  const DepthAndNormal maps = ReadMaps(depth_path, normal_path, camera);
  return FromColmapMaps(maps.depth, maps.normal, camera);
}

std::vector<float> ReadInverseDepths(const std::filesystem::path& depth_path,
                                     const std::filesystem::path& normal_path,
                                     const Camera& camera,
                                     int more_levels) {
  const DepthAndNormal maps = ReadMaps(depth_path, normal_path, camera);
  const int factor = 1 << more_levels;
  const Camera coarse = LevelCamera(camera, more_levels);
  const auto middle_of = [&](int block, int size) {
    return std::min(block * factor + (factor - 1) / 2, size - 1);
  };
  const auto center_of = [&](int block) {
    return (static_cast<float>(block) + 0.5f) * static_cast<float>(factor) -
           0.5f;
  };
  std::vector<float> inverse(static_cast<size_t>(coarse.width) * coarse.height,
                             0.0f);
  ForEachPlane(
      {maps.depth, maps.normal},
      camera,
      [&](size_t i, const Plane& plane, float) {
        const int row = static_cast<int>(i / camera.width);
        const int col = static_cast<int>(i % camera.width);
        const int block_row = row / factor;
        const int block_col = col / factor;
        if (row != middle_of(block_row, camera.height) ||
            col != middle_of(block_col, camera.width)) {
          return;
        }
        const float z =
            DepthAt(camera, plane, center_of(block_col), center_of(block_row));
        if (!std::isfinite(z) || !(z > 0)) return;
        inverse[static_cast<size_t>(block_row) * coarse.width + block_col] =
            1 / z;
      });
  return inverse;
}

}  // namespace hpm
