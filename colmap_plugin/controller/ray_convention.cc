#include "colmap_plugin/controller/ray_convention.h"

#include "src/base/error.h"
#include "src/image/middle_pixel.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// Where COLMAP's ray of (col, row) meets the library's pixel grid.
constexpr float kColmapShift = -0.5f;

// do_band(first_row, num_rows), by several threads.
template <class DoBand>
void ForEachBand(int width, int height, const DoBand& do_band) {
  constexpr int kBandPixels = 1 << 15;
  const int band_rows = std::clamp(kBandPixels / width, 1, height);
  tbb::parallel_for(0, (height + band_rows - 1) / band_rows, [&](int band) {
    const int begin = band * band_rows;
    do_band(begin, std::min(band_rows, height - begin));
  });
}

// The files of an image, in bands of rows: neither is ever in memory as a
// whole.
class MapPair {
 public:
  MapPair(const std::filesystem::path& depth_path,
          const std::filesystem::path& normal_path,
          const Camera& camera)
      : depth_(depth_path), normal_(normal_path), camera_(camera) {
    CheckSize(depth_, 1);
    CheckSize(normal_, 3);
  }

  // visit(col, row, plane) for every pixel, by several threads; the distance is
  // 0 where there is no depth.
  template <class Visit>
  void ForEachPlane(const Visit& visit) const {
    const int width = camera_.width;
    ForEachBand(width, camera_.height, [&](int begin, int num_rows) {
      const size_t size = static_cast<size_t>(num_rows) * width;
      std::vector<float> values(4 * size);
      depth_.ReadRows(0, begin, num_rows, values.data());
      for (int axis = 0; axis < 3; ++axis)
        normal_.ReadRows(axis, begin, num_rows, &values[(1 + axis) * size]);
      const float* at = values.data();
      for (int row = begin; row < begin + num_rows; ++row) {
        for (int col = 0; col < width; ++col, ++at) {
          const Vec3f normal = {at[size], at[2 * size], at[3 * size]};
          Plane plane = PlaneFromDepth(camera_,
                                       static_cast<float>(col) + kColmapShift,
                                       static_cast<float>(row) + kColmapShift,
                                       at[0],
                                       normal);
          const float z = DepthAt(
              camera_, plane, static_cast<float>(col), static_cast<float>(row));
          if (!(at[0] > 0 && std::isfinite(z) && z > 0 && plane.distance > 0))
            plane = {{0, 0, 0}, 0};
          visit(col, row, plane);
        }
      }
    });
  }

 private:
  void CheckSize(const MapReader& reader, int channels) const {
    const MapHeader& header = reader.header();
    if (header.width == camera_.width && header.height == camera_.height &&
        header.channels == channels) {
      return;
    }
    throw Error(ErrorCode::kBadInput,
                reader.path().string() +
                    ": not the size of its image; delete it and run again");
  }

  MapReader depth_, normal_;
  const Camera& camera_;
};

}  // namespace

WrittenDepths WritePlanes(const HypothesisMap& map,
                          const Camera& camera,
                          const DepthRange& range,
                          const std::vector<bool>* keep,
                          MapWriter* depth,
                          MapWriter* normal) {
  WrittenDepths written;
  std::mutex mutex;  // guards it
  ForEachBand(map.width, map.height, [&](int begin, int num_rows) {
    const size_t size = static_cast<size_t>(num_rows) * map.width;
    std::vector<float> values(4 * size, 0.0f);
    WrittenDepths band;
    float* at = values.data();
    size_t i = static_cast<size_t>(begin) * map.width;
    for (int row = begin; row < begin + num_rows; ++row) {
      for (int col = 0; col < map.width; ++col, ++i, ++at) {
        const Plane& plane = map.planes[i];
        if (!(plane.distance > 0) || (keep != nullptr && !(*keep)[i])) continue;
        const float z = DepthAt(camera,
                                plane,
                                static_cast<float>(col) + kColmapShift,
                                static_cast<float>(row) + kColmapShift);
        if (!std::isfinite(z) || !(z > 0)) continue;
        if (!(z >= range.min && z <= range.max)) {
          ++band.num_dropped;
          continue;
        }
        ++band.num_valid;
        band.costs.Add(map.costs[i]);
        at[0] = z;
        at[size] = plane.normal.x;
        at[2 * size] = plane.normal.y;
        at[3 * size] = plane.normal.z;
      }
    }
    depth->WriteRows(0, begin, num_rows, values.data());
    for (int axis = 0; axis < 3; ++axis)
      normal->WriteRows(axis, begin, num_rows, &values[(1 + axis) * size]);
    const std::lock_guard<std::mutex> lock(mutex);
    written.num_valid += band.num_valid;
    written.num_dropped += band.num_dropped;
    written.costs += band.costs;
  });
  return written;
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

void ReadPlanes(const std::filesystem::path& depth_path,
                const std::filesystem::path& normal_path,
                const Camera& camera,
                std::vector<Plane>* planes) {
  const MapPair maps(depth_path, normal_path, camera);
  planes->resize(static_cast<size_t>(camera.width) * camera.height);
  maps.ForEachPlane([&](int col, int row, const Plane& plane) {
    (*planes)[static_cast<size_t>(row) * camera.width + col] = plane;
  });
}

InverseDepthMap ReadInverseDepths(const std::filesystem::path& depth_path,
                                  const std::filesystem::path& normal_path,
                                  const Camera& camera,
                                  int more_levels) {
  const MapPair maps(depth_path, normal_path, camera);
  const MiddlePixel middle(more_levels);
  const Camera coarse = LevelCamera(camera, more_levels);
  const size_t size = static_cast<size_t>(coarse.width) * coarse.height;
  // Not filled here: each pixel has one in its middle.
  const std::unique_ptr<float[]> inverse(new float[size]);
  maps.ForEachPlane([&](int col, int row, const Plane& plane) {
    const int block_row = middle.BlockOf(row);
    const int block_col = middle.BlockOf(col);
    if (row != middle.Of(block_row, camera.height) ||
        col != middle.Of(block_col, camera.width)) {
      return;
    }
    inverse[static_cast<size_t>(block_row) * coarse.width + block_col] =
        InverseDepthOfBlock(camera, plane, middle, block_col, block_row);
  });
  return InverseDepthMap::Of(inverse.get(), size);
}

}  // namespace hpm
