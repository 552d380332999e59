// Maps as the program writes them.
#pragma once

#include "colmap_plugin/controller/ray_convention.h"
#include "tests/base/scratch_folder.h"

#include <filesystem>
#include <limits>
#include <vector>

namespace hpm {

constexpr DepthRange kAllDepths = {0, std::numeric_limits<float>::infinity()};

inline WrittenDepths WriteMaps(const HypothesisMap& map,
                               const Camera& camera,
                               const std::filesystem::path& depth_path,
                               const std::filesystem::path& normal_path,
                               const std::vector<bool>* keep = nullptr,
                               const DepthRange& range = kAllDepths) {
  MapWriter depth(depth_path, {map.width, map.height, 1});
  MapWriter normal(normal_path, {map.width, map.height, 3});
  const WrittenDepths written =
      WritePlanes(map, camera, range, keep, &depth, &normal);
  normal.Commit();
  depth.Commit();
  return written;
}

// What the files hold.
inline DepthAndNormal WrittenMaps(const HypothesisMap& map,
                                  const Camera& camera,
                                  const std::vector<bool>* keep = nullptr) {
  const ScratchFolder folder;
  WriteMaps(map, camera, folder / "depth.bin", folder / "normal.bin", keep);
  return {ReadMap(folder / "depth.bin"), ReadMap(folder / "normal.bin")};
}

}  // namespace hpm
