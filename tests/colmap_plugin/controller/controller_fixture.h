// A small workspace, the options of a quick run over it, and what the run said
// and left.
#pragma once

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/formats/map_file.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {

constexpr int kNumImages = 4;
constexpr int kWidth = 40;
constexpr int kHeight = 30;

class ControllerTest : public testing::Test {
 protected:
  ControllerTest() {
    options_.workspace.path = scene_.path();
    options_.hpm.method = "nesp";
    options_.hpm.num_iterations = 2;
    options_.hpm.num_geom_iterations = 1;
    options_.patch_match.num_threads = 2;
    options_.patch_match.cache_size = 0.1;
  }

  RunSummary Run() {
    PatchMatchController controller(
        options_,
        [this](LogLevel level, const std::string& line) {
          if (level == LogLevel::kWarning) warnings_.push_back(line);
          if (on_line_) on_line_(line);
        },
        [this](const ProgressEvent& event) {
          events_.push_back(event);
          if (on_progress_) on_progress_(event);
        },
        cancel_);
    return controller.Run();
  }

  std::filesystem::path MapPath(const std::string& folder,
                                int image,
                                const std::string& stage) const {
    return scene_.path() / "stereo" / folder /
           (ViewName(image) + "." + stage + ".bin");
  }

  std::vector<float> Depth(int image, const std::string& stage) const {
    return ReadMap(MapPath("depth_maps", image, stage)).data;
  }

  std::vector<std::filesystem::path> FilesNamedLike(
      const std::string& part) const {
    std::vector<std::filesystem::path> found;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(scene_.path())) {
      if (entry.path().filename().string().find(part) != std::string::npos) {
        found.push_back(entry.path());
      }
    }
    return found;
  }

  // Folders of maps between stages.
  std::vector<std::string> InnerFolders() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(
             scene_.path() / "stereo/hpm_mvs")) {
      const std::string name = entry.path().filename().string();
      if (entry.is_directory() && name != "stamps" &&
          name != "unreadable_images")
        found.push_back(name);
    }
    return found;
  }

  SceneWorkspace scene_{SmallScene(kNumImages, kWidth, kHeight)};
  ControllerOptions options_;
  CancelToken cancel_;
  std::vector<ProgressEvent> events_;
  std::vector<std::string> warnings_;
  std::function<void(const ProgressEvent&)> on_progress_;
  std::function<void(const std::string&)> on_line_;
};

}  // namespace hpm
