#include "colmap_plugin/workspace/workspace.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/pmvs.h"
#include "colmap_plugin/workspace/working_camera.h"
#include "src/base/error.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

bool EqualsIgnoringCase(const std::string& text,
                        const std::string& upper_case) {
  return std::equal(
      text.begin(),
      text.end(),
      upper_case.begin(),
      upper_case.end(),
      [](char a, char b) {
        return (a >= 'a' && a <= 'z' ? static_cast<char>(a - 'a' + 'A') : a) ==
               b;
      });
}

bool IsPmvs(const WorkspaceOptions& options) {
  if (EqualsIgnoringCase(options.format, "PMVS")) return true;
  if (EqualsIgnoringCase(options.format, "COLMAP")) return false;
  throw Error(
      ErrorCode::kUsage,
      fmt::format("--workspace_format {} is unknown; give COLMAP or PMVS",
                  QuotedName(options.format)));
}

bool SameAspectRatio(const SparseCamera& camera, const ImageSize& size) {
  // Rounding both sides to whole pixels stays below this even for thumbnails.
  constexpr double kTolerance = 0.02;
  const double scale_x = size.width / static_cast<double>(camera.width);
  const double scale_y = size.height / static_cast<double>(camera.height);
  return std::abs(scale_x / scale_y - 1) <= kTolerance;
}

// PMVS models do not hold the sizes of their images.
std::pair<int, int> SizeOfPmvsImage(const fs::path& path) {
  const std::optional<ImageSize> size = ReadImageSize(path);
  if (!size) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{} is missing or no image; its size is needed",
                            path.string()));
  }
  return {size->width, size->height};
}

Eigen::Vector3d CenterOf(const SparseImage& image) {
  return -(image.cam_from_world_rotation.conjugate() *
           image.cam_from_world_translation);
}

}  // namespace

Workspace::Workspace(const WorkspaceOptions& options, const LogSink& log)
    : options_(options), is_pmvs_(IsPmvs(options)) {
  if (is_pmvs_) {
    ReadPmvs();
  } else {
    model_ = ReadSparseModel(options_.path / "sparse", log);
  }
  CheckNames();
  MakeCameras(log);
}

int Workspace::ImageIndex(const std::string& name) const {
  const auto it = index_of_name_.find(name);
  return it == index_of_name_.end() ? -1 : it->second;
}

Camera Workspace::CameraAround(int index, int origin) const {
  const Eigen::Vector3d t = model_.images[index].cam_from_world_rotation *
                            (centers_[origin] - centers_[index]);
  Camera camera = cameras_[index];
  camera.t = {static_cast<float>(t.x()),
              static_cast<float>(t.y()),
              static_cast<float>(t.z())};
  return camera;
}

double Workspace::Depth(int index, const Eigen::Vector3d& xyz) const {
  return (model_.images[index].cam_from_world_rotation *
          (xyz - centers_[index]))
      .z();
}

fs::path Workspace::ImagePath(int index) const {
  return options_.path / (is_pmvs_ ? "visualize" : "images") / ImageName(index);
}

ImageDecoding Workspace::Decoding(int index) const {
  ImageDecoding decoding;
  const std::optional<ImageSize>& file = file_size(index);
  if (!file) return decoding;
  if (file->depth != SampleDepth::k8) decoding.stretch = deep_range_;
  if (file->is_jpeg) {
    const Camera& camera = cameras_[index];
    decoding.reduction =
        ReductionFor(file->width, file->height, camera.width, camera.height);
    decoding.file_width = file->width;
    decoding.file_height = file->height;
  }
  return decoding;
}

fs::path Workspace::StereoPath() const {
  return options_.path /
         (is_pmvs_ ? "stereo-" + options_.pmvs_option_name : "stereo");
}

fs::path Workspace::MapPath(int index,
                            MapKind kind,
                            const std::string& stage) const {
  const char* folder = "consistency_graphs";
  if (kind == MapKind::kDepth) folder = "depth_maps";
  if (kind == MapKind::kNormal) folder = "normal_maps";
  return StereoPath() / folder / (ImageName(index) + "." + stage + ".bin");
}

void Workspace::ReadPmvs() {
  PmvsModel pmvs = ReadPmvsModel(options_.path, SizeOfPmvsImage);
  const std::vector<int> images =
      ReadPmvsOptionFile(options_.path / options_.pmvs_option_name,
                         static_cast<int>(pmvs.sparse.images.size()));
  WritePatchMatchCfg(PatchMatchCfgPath(), MakePmvsCfgEntries(pmvs, images));
  std::vector<std::string> names;
  for (const int image : images)
    names.push_back(pmvs.sparse.images[image].name);
  WriteFusionCfg(FusionCfgPath(), names);
  model_ = std::move(pmvs.sparse);
}

void Workspace::CheckNames() {
  for (int i = 0; i < num_images(); ++i) {
    CheckImageName(ImageName(i));
    if (!index_of_name_.emplace(ImageName(i), i).second) {
      throw Error(
          ErrorCode::kBadInput,
          fmt::format("{}: two images have the name {}; remove one of them",
                      options_.path.string(),
                      QuotedName(ImageName(i))));
    }
  }
}

void Workspace::MakeCameras(const LogSink& log) {
  std::string note;  // on the first image of another size than its camera
  int num_other_size = 0;
  std::string why_not;
  for (int i = 0; i < num_images(); ++i) {
    const SparseImage& image = model_.images[i];
    const SparseCamera& sparse_camera = model_.cameras.at(image.camera_id);
    const std::optional<ImageSize> size = ReadImageSize(ImagePath(i));
    const std::optional<Camera> camera = MakeWorkingCamera(
        sparse_camera, image, size, options_.max_image_size, &why_not);
    cameras_.push_back(camera.value_or(Camera{}));
    centers_.push_back(CenterOf(image));
    usable_.push_back(camera.has_value());
    file_sizes_.push_back(size);
    if (!camera) {
      if (log)
        log(LogLevel::kWarning,
            fmt::format("Image {} is not used: {}.", image.name, why_not));
      continue;
    }
    if (!size ||
        (static_cast<uint64_t>(size->width) == sparse_camera.width &&
         static_cast<uint64_t>(size->height) == sparse_camera.height)) {
      continue;
    }
    const std::string sizes = fmt::format("{} is {}x{}, its camera {}x{}",
                                          image.name,
                                          size->width,
                                          size->height,
                                          sparse_camera.width,
                                          sparse_camera.height);
    if (num_other_size++ == 0) note = sizes;
    if (log && !SameAspectRatio(sparse_camera, *size)) {
      log(LogLevel::kWarning,
          fmt::format("Image {}: the proportions differ, check that images/ "
                      "holds the undistorted "
                      "images.",
                      sizes));
    }
  }
  if (log && num_other_size > 0) {
    log(LogLevel::kInfo,
        fmt::format("{} images have another size than their camera ({}); the "
                    "cameras are scaled "
                    "to the images.",
                    num_other_size,
                    note));
  }
  if (num_images() > 0 &&
      std::find(usable_.begin(), usable_.end(), true) == usable_.end()) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{}: no image can be used; the last one, {}: {}",
                            options_.path.string(),
                            ImageName(num_images() - 1),
                            why_not));
  }
}

}  // namespace hpm
