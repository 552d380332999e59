// Puts the records of a sparse model together and refuses contradictions
// (repeated or dangling ids), but for tracks that name images which are no
// longer there: those elements are left out and counted. The binary and the
// text reader feed it in this order: cameras, images, rigs, frames, points.
// Errors are raised at the cursor of the record.
#pragma once

#include "colmap_plugin/formats/input_cursor.h"
#include "colmap_plugin/formats/model_pose.h"
#include "colmap_plugin/formats/sparse_model.h"

#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace hpm {

// Ordered as COLMAP orders the data of a frame: by kind, then by id.
struct SensorId {
  int32_t type = 0;
  uint32_t id = 0;  // of a camera: the camera id

  bool operator<(const SensorId& other) const {
    return std::pair(type, id) < std::pair(other.type, other.id);
  }
};

constexpr int32_t kCameraSensor = 0;
constexpr int32_t kImuSensor = 1;

struct RigSensor {
  SensorId id;
  // Nothing if unknown. The reference sensor is the rig's origin.
  std::optional<PoseRecord> sensor_from_rig;
};

struct FrameData {
  SensorId sensor;
  uint64_t id = 0;  // of a camera: the image id

  bool operator<(const FrameData& other) const {
    return std::pair(sensor, id) < std::pair(other.sensor, other.id);
  }
};

class SparseModelBuilder {
 public:
  explicit SparseModelBuilder(const CancelToken* cancel) : cancel_(cancel) {}

  void AddCamera(const InputCursor& cursor, uint32_t id, SparseCamera camera);

  void AddImage(const InputCursor& cursor,
                uint32_t id,
                const PoseRecord& cam_from_world,
                uint32_t camera_id,
                std::string name);

  void AddRig(const InputCursor& cursor,
              uint32_t id,
              const std::vector<RigSensor>& sensors);

  void AddFrame(const InputCursor& cursor,
                uint32_t id,
                uint32_t rig_id,
                const PoseRecord& rig_from_world,
                const std::set<FrameData>& data);

  // After the last frame: gives the images the poses and the order of the
  // frames. A model without rigs and frames keeps those of its images file.
  void ApplyFrames(const InputCursor& cursor);

  // At most so many are about to come.
  void ReservePoints(size_t num_points, size_t num_elements) {
    model_.points.Reserve(num_points, num_elements);
    point_ids_.reserve(num_points);
  }

  // Throws Error(kInterrupted): models take seconds to read.
  void AddPoint(const InputCursor& cursor,
                uint64_t id,
                const Eigen::Vector3d& xyz,
                const std::vector<uint32_t>& track_image_ids);

  // After the last point.
  void CheckPointIds(const InputCursor& cursor);

  // Of the images file, in the order of the images, if frames replaced them;
  // else empty.
  const std::vector<RigidPose>& replaced_poses() const {
    return replaced_poses_;
  }

  const SparseModel& model() const { return model_; }
  SparseModel Release() { return std::move(model_); }

 private:
  const CancelToken* cancel_;
  SparseModel model_;
  std::unordered_map<uint32_t, int> image_index_;
  // Per rig: sensor_from_rig of each sensor, where it is known.
  std::map<uint32_t, std::map<SensorId, std::optional<RigidPose>>> rigs_;
  std::set<uint32_t> frame_ids_;
  // In frame order: image id and cam_from_world.
  std::vector<std::pair<uint32_t, RigidPose>> frame_images_;
  std::set<uint32_t> images_in_frames_;
  std::vector<RigidPose> replaced_poses_;
  std::vector<std::pair<uint64_t, uint64_t>>
      point_ids_;           // id, place in the file
  std::vector<int> track_;  // of the newest point
};

}  // namespace hpm
