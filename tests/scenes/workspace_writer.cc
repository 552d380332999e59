#include "tests/scenes/workspace_writer.h"

#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "src/base/error.h"
#include "tests/scenes/sparse_writer.h"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

// Colours are a fixed tint of the grey value, so that fused colours can be
// checked.
void WriteImage(const std::filesystem::path& path, const RenderedView& view) {
  cv::Mat bgr(view.camera.height, view.camera.width, CV_8UC3);
  for (int row = 0; row < bgr.rows; ++row) {
    for (int col = 0; col < bgr.cols; ++col) {
      const uint8_t grey = view.grey[static_cast<size_t>(row) * bgr.cols + col];
      bgr.at<cv::Vec3b>(row, col) = {
          static_cast<uint8_t>(grey * 3 / 4), grey, grey};
    }
  }
  if (!cv::imwrite(path.string(), bgr)) {
    throw Error(ErrorCode::kFailure, path.string() + ": cannot be written");
  }
}

Map DepthMap(const Camera& camera, const TrueMaps& maps) {
  return {camera.width, camera.height, 1, maps.depth};
}

Map NormalMap(const Camera& camera, const TrueMaps& maps) {
  Map map{camera.width, camera.height, 3, {}};
  for (const Vec3f& normal : maps.normals) map.data.push_back(normal.x);
  for (const Vec3f& normal : maps.normals) map.data.push_back(normal.y);
  for (const Vec3f& normal : maps.normals) map.data.push_back(normal.z);
  return map;
}

}  // namespace

std::string ViewName(int index) { return fmt::format("view{:02}.png", index); }

std::vector<RenderedView> WriteWorkspace(const TestScene& scene,
                                         const std::filesystem::path& folder) {
  for (const char* name : {"images",
                           "stereo/depth_maps",
                           "stereo/normal_maps",
                           "stereo/consistency_graphs",
                           "gt/depth_maps",
                           "gt/normal_maps"}) {
    std::filesystem::create_directories(folder / name);
  }
  std::vector<RenderedView> views = RenderViews(scene);
  std::vector<std::string> names;
  std::vector<PatchMatchCfgEntry> entries;
  for (size_t i = 0; i < views.size(); ++i) {
    const RenderedView& view = views[i];
    const std::string name = ViewName(static_cast<int>(i));
    names.push_back(name);
    PatchMatchCfgEntry entry;
    entry.ref_name = name;
    entry.max_num_auto = 20;
    entries.push_back(entry);
    WriteImage(folder / "images" / name, view);
    WriteMap(folder / "gt/depth_maps" / (name + ".bin"),
             DepthMap(view.camera, view.truth));
    WriteMap(folder / "gt/normal_maps" / (name + ".bin"),
             NormalMap(view.camera, view.truth));
  }
  WriteSparseModel(
      folder / "sparse", scene.cameras, names, SampleSurface(scene, 200));
  WritePatchMatchCfg(folder / "stereo/patch-match.cfg", entries);
  WriteFusionCfg(folder / "stereo/fusion.cfg", names);
  return views;
}

void WriteTruthAsMaps(const TestScene& scene,
                      const std::filesystem::path& folder,
                      const std::string& stage) {
  for (size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& camera = scene.cameras[i];
    const TrueMaps maps = RenderTrueMaps(scene, camera, -0.5);
    const std::string name =
        ViewName(static_cast<int>(i)) + "." + stage + ".bin";
    WriteMap(folder / "stereo/normal_maps" / name, NormalMap(camera, maps));
    WriteMap(folder / "stereo/depth_maps" / name, DepthMap(camera, maps));
  }
}

}  // namespace hpm
