#include "colmap_plugin/formats/sparse_model_builder.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace hpm {

void SparseModelBuilder::AddCamera(const InputCursor& cursor,
                                   uint32_t id,
                                   SparseCamera camera) {
  constexpr uint64_t kMaxSize = std::numeric_limits<int>::max();
  for (const uint64_t size : {camera.width, camera.height}) {
    if (size < 1 || size > kMaxSize) {
      cursor.Fail(fmt::format(
          "camera {} has the size {}x{}", id, camera.width, camera.height));
    }
  }
  if (!model_.cameras.emplace(id, std::move(camera)).second) {
    cursor.Fail(fmt::format("camera id {} occurs twice", id));
  }
}

void SparseModelBuilder::AddImage(const InputCursor& cursor,
                                  uint32_t id,
                                  const PoseRecord& cam_from_world,
                                  uint32_t camera_id,
                                  std::string name) {
  if (model_.cameras.count(camera_id) == 0) {
    cursor.Fail(
        fmt::format("image {} has the unknown camera {}", id, camera_id));
  }
  if (!image_index_.emplace(id, static_cast<int>(model_.images.size()))
           .second) {
    cursor.Fail(fmt::format("image id {} occurs twice", id));
  }
  SparseImage image;
  image.id = id;
  image.name = std::move(name);
  image.camera_id = camera_id;
  const RigidPose pose = MakePose(cam_from_world);
  image.cam_from_world_rotation = pose.rotation;
  image.cam_from_world_translation = pose.translation;
  model_.images.push_back(std::move(image));
}

void SparseModelBuilder::AddRig(const InputCursor& cursor,
                                uint32_t id,
                                const std::vector<RigSensor>& sensors) {
  const auto [rig, is_new] = rigs_.try_emplace(id);
  if (!is_new) cursor.Fail(fmt::format("rig id {} occurs twice", id));
  for (const RigSensor& sensor : sensors) {
    std::optional<RigidPose> pose;
    if (sensor.sensor_from_rig) pose = MakePose(*sensor.sensor_from_rig);
    if (!rig->second.emplace(sensor.id, pose).second) {
      cursor.Fail(fmt::format("rig {} has sensor {} twice", id, sensor.id.id));
    }
  }
}

void SparseModelBuilder::AddFrame(const InputCursor& cursor,
                                  uint32_t id,
                                  uint32_t rig_id,
                                  const PoseRecord& rig_from_world,
                                  const std::set<FrameData>& data) {
  if (!frame_ids_.insert(id).second)
    cursor.Fail(fmt::format("frame id {} occurs twice", id));
  const auto rig = rigs_.find(rig_id);
  if (rig == rigs_.end())
    cursor.Fail(fmt::format("frame {} has the unknown rig {}", id, rig_id));
  const RigidPose frame_pose = MakePose(rig_from_world);
  for (const FrameData& item : data) {
    const auto sensor = rig->second.find(item.sensor);
    if (sensor == rig->second.end()) {
      cursor.Fail(
          fmt::format("frame {} has data of sensor {}, which rig {} lacks",
                      id,
                      item.sensor.id,
                      rig_id));
    }
    if (item.sensor.type != kCameraSensor) continue;
    const auto image_id = static_cast<uint32_t>(item.id);
    const auto index = image_index_.find(image_id);
    if (image_id != item.id || index == image_index_.end()) {
      cursor.Fail(
          fmt::format("frame {} has the unknown image {}", id, item.id));
    }
    const SparseImage& image =
        model_.images[static_cast<size_t>(index->second)];
    if (image.camera_id != item.sensor.id) {
      cursor.Fail(fmt::format(
          "frame {} gives image {} the camera {}, the images file {}",
          id,
          image_id,
          item.sensor.id,
          image.camera_id));
    }
    if (!images_in_frames_.insert(image_id).second) {
      cursor.Fail(fmt::format("image {} is in two frames", image_id));
    }
    if (!sensor->second) {
      cursor.Fail(fmt::format(
          "frame {} has image {} of camera {}, which has no pose in rig {}",
          id,
          image_id,
          item.sensor.id,
          rig_id));
    }
    frame_images_.emplace_back(image_id, Composed(*sensor->second, frame_pose));
  }
}

void SparseModelBuilder::ApplyFrames(const InputCursor& cursor) {
  if (rigs_.empty() && frame_ids_.empty()) return;
  for (const SparseImage& image : model_.images) {
    if (images_in_frames_.count(image.id) == 0) {
      cursor.Fail(fmt::format("image {} is in no frame", image.id));
    }
  }
  std::vector<SparseImage> ordered;
  ordered.reserve(model_.images.size());
  for (const auto& [id, pose] : frame_images_) {
    int& index = image_index_.at(id);
    SparseImage& image = model_.images[static_cast<size_t>(index)];
    replaced_poses_.push_back(
        {image.cam_from_world_rotation, image.cam_from_world_translation});
    image.cam_from_world_rotation = pose.rotation;
    image.cam_from_world_translation = pose.translation;
    ordered.push_back(std::move(image));
    index = static_cast<int>(ordered.size()) - 1;
  }
  model_.images = std::move(ordered);
}

void SparseModelBuilder::AddPoint(
    const InputCursor& cursor,
    uint64_t id,
    const Eigen::Vector3d& xyz,
    const std::vector<uint32_t>& track_image_ids) {
  constexpr size_t kPointsBetweenLooks = 4096;
  if (point_ids_.size() % kPointsBetweenLooks == 0) cancel_->ThrowIfCancelled();
  track_.clear();
  for (const uint32_t image_id : track_image_ids) {
    const auto it = image_index_.find(image_id);
    ++model_.num_observations;
    if (it != image_index_.end()) {
      track_.push_back(it->second);
    } else if (model_.num_left_out++ == 0) {
      model_.left_out_example = image_id;
    }
  }
  point_ids_.emplace_back(id, cursor.place());
  if (xyz.allFinite()) model_.points.Add(xyz, track_);
}

void SparseModelBuilder::CheckPointIds(const InputCursor& cursor) {
  std::sort(point_ids_.begin(), point_ids_.end());
  const auto repeated = std::adjacent_find(
      point_ids_.begin(), point_ids_.end(), [](const auto& a, const auto& b) {
        return a.first == b.first;
      });
  if (repeated != point_ids_.end()) {
    cursor.FailAt((repeated + 1)->second,
                  fmt::format("point id {} occurs twice", repeated->first));
  }
  point_ids_ = {};
}

}  // namespace hpm
