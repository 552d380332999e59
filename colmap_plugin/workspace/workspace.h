// A dense workspace as image_undistorter leaves it: where files lie, the sparse
// model, and the cameras at working size.
#pragma once

#include "colmap_plugin/formats/sparse_model.h"
#include "colmap_plugin/workspace/image_files.h"
#include "src/base/cancel.h"
#include "src/base/log.h"
#include "src/core/camera.h"
#include "src/image/load_image.h"

#include <filesystem>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace hpm {

struct WorkspaceOptions {
  std::filesystem::path path;
  std::string format = "COLMAP";  // or "PMVS", any case
  std::string pmvs_option_name = "option-all";
  int max_image_size = -1;  // longest side in pixels, <= 0: off
  // Folder with a mask <image name>.png for each image that has one, of the
  // image's own size, 0 = ignored; empty: none.
  std::filesystem::path mask_path;
};

// Throws Error(kUsage) for an unknown format.
bool IsPmvs(const WorkspaceOptions& options);
// WS/stereo or WS/stereo-<option name>.
std::filesystem::path StereoPath(const WorkspaceOptions& options);

enum class MapKind { kDepth, kNormal, kConsistencyGraph, kConfidence };

class Workspace {
 public:
  // Reads the model, checks every image name and camera. An image whose camera
  // is unusable (distorted, not perspective, non-finite pose or focal <= 0)
  // keeps its index but is marked not usable, with a warning in `log` for all
  // with the same fault. An image
  // file of another size than its camera scales the camera, with a note; one
  // that is missing or has other proportions than its camera marks the image as
  // without picture, with one warning for all. PMVS: (re)writes patch-match.cfg
  // and fusion.cfg from the option file. Throws Error(kBadInput) naming the
  // missing or damaged file, or if no image is usable or has a picture, or for
  // masks that are not the images' or of another size;
  // Error(kUsage) for an unknown format, Error(kInterrupted).
  Workspace(const WorkspaceOptions& options,
            const LogSink& log,
            const CancelToken& cancel = {});

  int num_images() const { return static_cast<int>(model_.images.size()); }
  const SparseModel& model() const { return model_; }
  const std::string& ImageName(int index) const {
    return model_.images[index].name;
  }
  // '\\' counts as '/' if there is no image of just this name. -1 if there is
  // no such image.
  int ImageIndex(const std::string& name) const;
  // Whether patch match can use the camera.
  bool usable(int index) const { return usable_[index]; }
  // Whether there is an image file, and one that can be the camera's. Damage
  // that only decoding finds is not known here.
  bool has_picture(int index) const { return has_picture_[index]; }
  // Decoding found damage.
  void DropPicture(int index) { has_picture_[index] = false; }

  // At working size (max_image_size applied as COLMAP does), with the library's
  // pixel rule: integer (col, row) is the pixel centre (see working_camera.h).
  // Its own centre is the origin: t is zero. All zeros if the image is not
  // usable.
  const Camera& camera(int index) const { return cameras_[index]; }
  // The same in a frame whose origin is the centre of camera `origin`, axes as
  // in the model. A Camera is float32, and models lie millions of units from
  // their origin (UTM, ECEF): so differences are formed in double before.
  Camera CameraAround(int index, int origin) const;
  // Of the camera, in the model's frame; not a number if it is not usable.
  const Eigen::Vector3d& Center(int index) const { return centers_[index]; }
  // z of a point of the model in the frame of the camera.
  double Depth(int index, const Eigen::Vector3d& xyz) const;

  // Of the image file; nothing if it is missing or no image.
  const std::optional<ImageSize>& file_size(int index) const {
    return file_sizes_[index];
  }
  // The image's mask; empty if it has none.
  const std::filesystem::path& MaskPath(int index) const {
    return masks_[index].path;
  }
  const std::optional<ImageSize>& mask_size(int index) const {
    return masks_[index].size;
  }
  // How the image file becomes the grey image of the camera's size.
  ImageDecoding Decoding(int index) const;
  // For all images of more than 8 bits (see deep_images.h).
  void StretchDeepImages(const std::optional<GreyRange>& range) {
    deep_range_ = range;
  }

  const std::filesystem::path& ImagePath(int index) const {
    return image_paths_[index];
  }
  std::filesystem::path StereoPath() const { return hpm::StereoPath(options_); }
  std::filesystem::path PatchMatchCfgPath() const {
    return StereoPath() / "patch-match.cfg";
  }
  std::filesystem::path FusionCfgPath() const {
    return StereoPath() / "fusion.cfg";
  }
  // stereo/depth_maps/<name>.<stage>.bin etc.; stage is "photometric" or
  // "geometric".
  std::filesystem::path MapPath(int index,
                                MapKind kind,
                                const std::string& stage) const;
  // Our own state (run record, lock, maps between geometric passes):
  // stereo/hpm_mvs.
  std::filesystem::path StatePath() const { return StereoPath() / "hpm_mvs"; }

 private:
  void CheckFolder() const;
  void ReadPmvs();
  void CheckNames();
  void MakeCameras(const LogSink& log, const CancelToken& cancel);
  void FindMasks(const LogSink& log);
  std::filesystem::path ImageFolder() const;

  WorkspaceOptions options_;
  bool is_pmvs_ = false;
  SparseModel model_;
  std::vector<Camera> cameras_;
  std::vector<Eigen::Vector3d> centers_;
  std::vector<bool> usable_;
  std::vector<std::filesystem::path> image_paths_;
  std::vector<ImageFile> masks_;
  std::vector<bool> has_picture_;
  std::vector<std::optional<ImageSize>> file_sizes_;
  std::optional<GreyRange> deep_range_;
  std::unordered_map<std::string, int> index_of_name_;
};

}  // namespace hpm
