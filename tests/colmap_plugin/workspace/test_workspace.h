// Workspaces of a few images, written as text models into a temporary folder.
#pragma once

#include "colmap_plugin/workspace/workspace.h"
#include "src/base/error.h"
#include "tests/base/scratch_folder.h"

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {

// Enough of a PNG for its size to be read.
inline std::string PngHeader(uint32_t width, uint32_t height) {
  const auto big_endian = [](uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  return std::string("\x89PNG\r\n\x1a\n", 8) + big_endian(13) + "IHDR" +
         big_endian(width) + big_endian(height);
}

// The error that `function` throws, if any.
inline std::optional<Error> ErrorOf(const std::function<void()>& function) {
  try {
    function();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

class TestWorkspace {
 public:
  // One camera of id 1: PINHOLE 160x120, f = 100, centre of the image.
  TestWorkspace() { AddCamera(1, "PINHOLE 160 120 100 100 80 60"); }

  void AddCamera(int id, const std::string& model_size_params) {
    cameras_ += fmt::format("{} {}\n", id, model_size_params);
    std::istringstream words(model_size_params);
    std::string model;
    words >> model >> sizes_[id].first >> sizes_[id].second;
  }

  // Looks along +z of the world from `center`.
  int AddImage(const std::string& name,
               const Eigen::Vector3d& center,
               int camera_id = 1) {
    return AddImagePose(
        name,
        fmt::format("1 0 0 0 {} {} {}", -center.x(), -center.y(), -center.z()),
        camera_id);
  }

  int AddImagePose(const std::string& name,
                   const std::string& pose,
                   int camera_id = 1) {
    images_ +=
        fmt::format("{} {} {} {}\n\n", 10 + num_images_, pose, camera_id, name);
    names_.emplace_back(name, camera_id);
    return num_images_++;
  }

  // Images have a file of their camera's size, or the one that the test wrote,
  // but for these.
  void LeaveOutFile(const std::string& name) { without_file_.insert(name); }

  void AddPoint(const Eigen::Vector3d& xyz, const std::vector<int>& images) {
    points_ += fmt::format(
        "{} {} {} {} 0 0 0 0", ++num_points_, xyz.x(), xyz.y(), xyz.z());
    for (const int image : images) points_ += fmt::format(" {} 0", 10 + image);
    points_ += "\n";
  }

  void WriteCfg(const std::string& text) {
    WriteFile(path() / "stereo/patch-match.cfg", text);
  }

  const std::filesystem::path& path() const { return folder_.path(); }

  Workspace Open(int max_image_size = -1) {
    WriteImageFiles();
    WriteFile(path() / "sparse/cameras.txt", cameras_);
    WriteFile(path() / "sparse/images.txt", images_);
    WriteFile(path() / "sparse/points3D.txt", points_);
    WorkspaceOptions options;
    options.path = path();
    options.max_image_size = max_image_size;
    return Workspace(options, Log());
  }

  LogSink Log() {
    return [this](LogLevel level, const std::string& line) {
      log_.emplace_back(level, line);
    };
  }
  std::vector<std::string> LinesOf(LogLevel level) const {
    std::vector<std::string> lines;
    for (const auto& [line_level, line] : log_) {
      if (line_level == level) lines.push_back(line);
    }
    return lines;
  }
  std::vector<std::string> Warnings() const {
    return LinesOf(LogLevel::kWarning);
  }
  std::vector<std::string> Notes() const { return LinesOf(LogLevel::kInfo); }

 private:
  void WriteImageFiles() const {
    for (const auto& [name, camera] : names_) {
      const std::filesystem::path file = path() / "images" / name;
      if (without_file_.count(name) > 0 || name.front() == '/' ||
          name.find("..") != std::string::npos ||
          std::filesystem::exists(file)) {
        continue;
      }
      const auto [width, height] = sizes_.at(camera);
      WriteFile(file, PngHeader(width, height));
    }
  }

  ScratchFolder folder_;
  std::map<int, std::pair<uint32_t, uint32_t>> sizes_;  // of cameras
  std::vector<std::pair<std::string, int>> names_;      // name, camera
  std::set<std::string> without_file_;
  std::string cameras_;
  std::string images_;
  std::string points_;
  int num_images_ = 0;
  int num_points_ = 0;
  std::vector<std::pair<LogLevel, std::string>> log_;
};

}  // namespace hpm
