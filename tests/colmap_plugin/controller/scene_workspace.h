// A small rendered scene as a workspace in a temporary folder.
#pragma once

#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/workspace.h"
#include "tests/scenes/workspace_writer.h"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hpm {

class SceneWorkspace {
 public:
  explicit SceneWorkspace(const SceneOptions& options) {
    std::string name =
        (std::filesystem::temp_directory_path() / "hpm_scene_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    path_ = name;
    views_ = WriteWorkspace(MakeTiltedPlane(options), path_);
  }
  ~SceneWorkspace() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  SceneWorkspace(const SceneWorkspace&) = delete;
  SceneWorkspace& operator=(const SceneWorkspace&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::vector<RenderedView>& views() const { return views_; }

  Workspace Open(int max_image_size = -1) const {
    WorkspaceOptions options;
    options.path = path_;
    options.max_image_size = max_image_size;
    return Workspace(options, [](LogLevel, const std::string&) {});
  }

 private:
  std::filesystem::path path_;
  std::vector<RenderedView> views_;
};

inline SceneOptions SmallScene(int num_views, int width, int height) {
  SceneOptions options;
  options.num_views = num_views;
  options.width = width;
  options.height = height;
  return options;
}

}  // namespace hpm
