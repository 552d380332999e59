#include "colmap_plugin/workspace/workspace.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/pmvs.h"
#include "colmap_plugin/workspace/image_files.h"
#include "colmap_plugin/workspace/planning_progress.h"
#include "colmap_plugin/workspace/working_camera.h"
#include "src/base/error.h"
#include "src/base/retries.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

// Reasons that differ only in their numbers are one reason.
std::string WithoutDigits(std::string text) {
  text.erase(std::remove_if(text.begin(),
                            text.end(),
                            [](char c) { return c >= '0' && c <= '9'; }),
             text.end());
  return text;
}

// Images that were filtered out stay in the tracks of many scripts' models,
// which COLMAP tolerates. If that is most of them, the files are of two models.
void ReportLeftOut(const SparseModel& model, const LogSink& log) {
  if (!log || model.num_left_out == 0) return;
  const bool most = 2 * model.num_left_out > model.num_observations;
  log(most ? LogLevel::kWarning : LogLevel::kInfo,
      fmt::format(
          "{} of {} observations of sparse points are left out: their "
          "images (the first: id {}) are not in the images file{}",
          model.num_left_out,
          model.num_observations,
          model.left_out_example,
          most ? "; check that images and points3D are of one model" : ""));
}

Eigen::Vector3d CenterOf(const SparseImage& image) {
  return -(image.cam_from_world_rotation.conjugate() *
           image.cam_from_world_translation);
}

}  // namespace

bool IsPmvs(const WorkspaceOptions& options) {
  if (EqualsIgnoringCase(options.format, "PMVS")) return true;
  if (EqualsIgnoringCase(options.format, "COLMAP")) return false;
  throw Error(
      ErrorCode::kUsage,
      fmt::format("--workspace_format {} is unknown; give COLMAP or PMVS",
                  QuotedName(options.format)));
}

fs::path StereoPath(const WorkspaceOptions& options) {
  return options.path /
         (IsPmvs(options) ? "stereo-" + options.pmvs_option_name : "stereo");
}

Workspace::Workspace(const WorkspaceOptions& options,
                     const LogSink& log,
                     const CancelToken& cancel)
    : options_(options), is_pmvs_(IsPmvs(options)) {
  if (is_pmvs_) {
    ReadPmvs();
  } else {
    CheckFolder();
    model_ = ReadSparseModel(options_.path / "sparse", log, cancel);
    ReportLeftOut(model_, log);
  }
  CheckNames();
  MakeCameras(log, cancel);
  FindMasks(log);
}

int Workspace::ImageIndex(const std::string& name) const {
  auto it = index_of_name_.find(name);
  if (it == index_of_name_.end()) it = index_of_name_.find(WithSlashes(name));
  return it == index_of_name_.end() ? -1 : it->second;
}

fs::path Workspace::ImageFolder() const {
  return options_.path / (is_pmvs_ ? "visualize" : "images");
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

ImageDecoding Workspace::Decoding(int index) const {
  ImageDecoding decoding;
  decoding.mask = MaskPath(index);
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

fs::path Workspace::MapPath(int index,
                            MapKind kind,
                            const std::string& stage) const {
  const char* folder = "consistency_graphs";
  if (kind == MapKind::kDepth) folder = "depth_maps";
  if (kind == MapKind::kNormal) folder = "normal_maps";
  if (kind == MapKind::kConfidence) folder = "confidence_maps";
  return StereoPath() / folder / (ImageName(index) + "." + stage + ".bin");
}

void Workspace::CheckFolder() const {
  if (!IsFolder(options_.path)) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("the workspace {} is no folder; give the path that "
                            "image_undistorter wrote to",
                            options_.path.string()));
  }
  if (!Exists(options_.path / "sparse") &&
      Exists(options_.path / "dense/sparse")) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{} has no folder sparse, but {} has; give that as "
                            "--workspace_path",
                            options_.path.string(),
                            (options_.path / "dense").string()));
  }
}

void Workspace::ReadPmvs() {
  PmvsModel pmvs = ReadPmvsModel(options_.path, SizeOfPmvsImage);
  const std::vector<int> images =
      ReadPmvsOptionFile(options_.path / options_.pmvs_option_name,
                         static_cast<int>(pmvs.sparse.images.size()));
  WritePatchMatchCfg(PatchMatchCfgPath(), MakePmvsCfgEntries(pmvs, images));
  std::vector<std::string> names;
  names.reserve(images.size());
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
  // After all exact names, which go first.
  for (int i = 0; i < num_images(); ++i)
    index_of_name_.emplace(WithSlashes(ImageName(i)), i);
}

void Workspace::MakeCameras(const LogSink& log, const CancelToken& cancel) {
  ImageFault backslashes, missing, unreadable, other_size, other_proportions,
      far_larger;
  std::map<std::string, ImageFault> bad_cameras;  // by reason
  std::string why_not;
  PlanningProgress progress(
      "Looking at image files", model_.images.size(), log, cancel);
  for (int i = 0; i < num_images(); ++i) {
    progress.Count();
    const SparseImage& image = model_.images[i];
    const SparseCamera& sparse_camera = model_.cameras.at(image.camera_id);
    const ImageFile file = FindImageFile(ImageFolder(), image.name);
    image_paths_.push_back(file.path);
    const ImageSize camera_size = {static_cast<int>(sparse_camera.width),
                                   static_cast<int>(sparse_camera.height)};
    // A header that cannot be right must not make the run too large for all.
    std::optional<ImageSize> size = file.size;
    if (size && (!SameProportions(camera_size, *size) ||
                 IsFarLarger(camera_size, *size))) {
      size = std::nullopt;
    }
    const std::optional<Camera> camera = MakeWorkingCamera(
        sparse_camera, image, size, options_.max_image_size, &why_not);
    cameras_.push_back(camera.value_or(Camera{}));
    centers_.push_back(CenterOf(image));
    usable_.push_back(camera.has_value());
    file_sizes_.push_back(size);
    has_picture_.push_back(file.exists);
    if (!camera) {
      bad_cameras[WithoutDigits(why_not)].Add(
          fmt::format("{}: {}", image.name, why_not));
      continue;
    }
    if (!file.exists) {
      // Looks through a folder, so only for the image that is named.
      missing.Add(missing.num() > 0
                      ? ""
                      : fmt::format("{}: {}",
                                    file.path.string(),
                                    WhyMissing(ImageFolder(), image.name)));
      continue;
    }
    if (file.path != ImageFolder() / image.name)
      backslashes.Add(QuotedName(image.name));
    if (!file.size) {
      unreadable.Add(file.path.string());
      has_picture_.back() = false;
      continue;
    }
    if ((file.size->width == camera_size.width &&
         file.size->height == camera_size.height)) {
      continue;
    }
    const std::string sizes = fmt::format("{} is {}x{}, its camera {}x{}",
                                          image.name,
                                          file.size->width,
                                          file.size->height,
                                          camera_size.width,
                                          camera_size.height);
    if (size) {
      other_size.Add(sizes);
      continue;
    }
    has_picture_.back() = false;
    (IsFarLarger(camera_size, *file.size) ? far_larger : other_proportions)
        .Add(sizes);
  }

  const int num_usable =
      static_cast<int>(std::count(usable_.begin(), usable_.end(), true));
  if (num_images() > 0 && num_usable == 0) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{}: no image can be used; the last one, {}: {}",
                            options_.path.string(),
                            ImageName(num_images() - 1),
                            why_not));
  }
  std::vector<std::string> faults;
  if (missing.num() > 0)
    faults.push_back(missing.Line(num_images(), "without a file"));
  if (unreadable.num() > 0) {
    faults.push_back(
        unreadable.Line(num_images(), "with a file that cannot be decoded") +
        "; undistort the images again");
  }
  if (other_proportions.num() > 0) {
    faults.push_back(
        other_proportions.Line(num_images(),
                               "with other proportions than their camera") +
        "; they are not used: undo a rotation after the reconstruction (by "
        "software or by its EXIF entry), or undistort the images again");
  }
  if (far_larger.num() > 0) {
    faults.push_back(
        far_larger.Line(num_images(), "far larger than their camera") +
        "; they are not used: undistort the images again");
  }
  const int num_faults = missing.num() + unreadable.num() +
                         other_proportions.num() + far_larger.num();
  if (num_usable > 0 && num_faults == num_usable) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{}", fmt::join(faults, "; ")));
  }
  if (!log) return;
  for (const auto& [reason, fault] : bad_cameras)
    log(LogLevel::kWarning, fault.Line(num_images(), "not used"));
  for (const std::string& fault : faults) log(LogLevel::kWarning, fault);
  if (backslashes.num() > 0) {
    log(LogLevel::kWarning,
        backslashes.Line(num_images(), "with backslashes in their names") +
            "; their files are found with '/' in their place, but "
            "stereo_fusion will not find them on this system: write the names "
            "in the sparse model with '/'");
  }
  if (other_size.num() > 0) {
    log(LogLevel::kInfo,
        fmt::format("{}; the cameras are scaled to the images.",
                    other_size.Line(num_images(),
                                    "of another size than their camera")));
  }
}

void Workspace::FindMasks(const LogSink& log) {
  masks_.assign(num_images(), {});
  const fs::path& folder = options_.mask_path;
  if (folder.empty()) return;
  constexpr const char* kNaming =
      "the mask of a/b.jpg is a/b.jpg.png below this folder, 0 = ignored, of "
      "the undistorted image";
  ImageFault missing, undecodable, other_size;
  int num_pictures = 0;
  for (int i = 0; i < num_images(); ++i) {
    if (!has_picture_[i] || !file_sizes_[i]) continue;
    ++num_pictures;
    const ImageFile mask = FindImageFile(folder, ImageName(i) + ".png");
    if (!mask.exists) {
      missing.Add(ImageName(i));
    } else if (!mask.size) {
      undecodable.Add(mask.path.string());
    } else if (mask.size->width != file_sizes_[i]->width ||
               mask.size->height != file_sizes_[i]->height) {
      other_size.Add(fmt::format("{} is {}x{}, its image {}x{}",
                                 mask.path.string(),
                                 mask.size->width,
                                 mask.size->height,
                                 file_sizes_[i]->width,
                                 file_sizes_[i]->height));
    } else {
      masks_[i] = mask;
    }
  }
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("--Hpm.mask_path {}: {}", folder.string(), what));
  };
  if (undecodable.num() > 0) {
    refuse(undecodable.Line(num_pictures, "with a mask that is no image") +
           "; write it again as PNG");
  }
  if (other_size.num() > 0) {
    refuse(other_size.Line(num_pictures, "with a mask of another size") +
           "; masks belong to the undistorted images: undistort them as the "
           "images were");
  }
  if (num_pictures > 0 && missing.num() == num_pictures)
    refuse(std::string("no image has a mask; ") + kNaming);
  if (!log) return;
  log(LogLevel::kInfo,
      fmt::format("Masks: {} of {} images have one; 0 = ignored, and they must "
                  "fit the undistorted images",
                  num_pictures - missing.num(),
                  num_pictures));
  if (missing.num() > 0) {
    log(LogLevel::kWarning,
        fmt::format("--Hpm.mask_path {}: {}; {}",
                    folder.string(),
                    missing.Line(num_pictures, "without a mask are used whole"),
                    kNaming));
  }
}

}  // namespace hpm
