#include "colmap_plugin/formats/frame_poses.h"

#include "colmap_plugin/formats/image_name.h"

#include <fmt/format.h>

namespace hpm {
namespace {

// Radians, and parts of the cameras' spread: a fifth of a pixel at a focal
// length of 2000, for a scene as far away as the cameras stand apart. Six
// digits of a text file stay below.
constexpr double kNoticeable = 1e-4;
constexpr double kDegrees = 180 / 3.14159265358979323846;

RigidPose PoseOf(const SparseImage& image) {
  return {image.cam_from_world_rotation, image.cam_from_world_translation};
}

// Distance between the ends of the longest side of the box around the cameras.
double Spread(const std::vector<SparseImage>& images) {
  Eigen::AlignedBox3d box;
  for (const SparseImage& image : images) {
    const Eigen::Vector3d center = CenterOf(PoseOf(image));
    if (center.allFinite()) box.extend(center);
  }
  return box.isEmpty() ? 0 : box.sizes().maxCoeff();
}

}  // namespace

std::string DescribeStalePoses(const std::vector<SparseImage>& images,
                               const std::vector<RigidPose>& images_file,
                               const std::string& extension) {
  const double spread = Spread(images);
  int num_stale = 0;
  std::string first;
  for (size_t i = 0; i < images.size(); ++i) {
    const RigidPose pose = PoseOf(images[i]);
    const double angle = AngleBetween(pose, images_file[i]);
    const Eigen::Vector3d center = CenterOf(pose);
    const double distance = (center - CenterOf(images_file[i])).norm();
    // Cameras at one place have no spread but that of the digits.
    const double scale = spread > 1e-6 * center.norm() ? spread : center.norm();
    // An image without a pose is refused in any case.
    if (!center.allFinite()) continue;
    if (angle <= kNoticeable && distance <= kNoticeable * scale) continue;
    if (num_stale++ > 0) continue;
    first = fmt::format("{} by {:.3g} degrees and {:.3g} units",
                        QuotedName(images[i].name),
                        angle * kDegrees,
                        distance);
  }
  if (num_stale == 0) return "";
  return fmt::format(
      "{0} of {1} images have another pose in images{2} than rigs{2} and "
      "frames{2} give (the first, {3}); those of rigs and frames are used, as "
      "COLMAP 3.12 and later does. If images{2} is right, or for fusion with "
      "an older COLMAP, delete rigs{2} and frames{2} or export the model "
      "again.",
      num_stale,
      images.size(),
      extension,
      first);
}

}  // namespace hpm
