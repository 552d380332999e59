// A small rendered scene as a workspace in a temporary folder.
#pragma once

#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/workspace.h"
#include "tests/base/scratch_folder.h"
#include "tests/scenes/workspace_writer.h"

#include <filesystem>
#include <vector>

namespace hpm {

class SceneWorkspace {
 public:
  explicit SceneWorkspace(const SceneOptions& options)
      : SceneWorkspace(MakeTiltedPlane(options)) {}
  explicit SceneWorkspace(const TestScene& scene)
      : views_(WriteWorkspace(scene, folder_.path())) {}
  const std::filesystem::path& path() const { return folder_.path(); }
  const std::vector<RenderedView>& views() const { return views_; }

  Workspace Open(int max_image_size = -1,
                 const std::filesystem::path& masks = {}) const {
    WorkspaceOptions options;
    options.path = path();
    options.mask_path = masks;
    options.max_image_size = max_image_size;
    return Workspace(options, [](LogLevel, const std::string&) {});
  }

 private:
  ScratchFolder folder_;
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
