// Puts the records of a sparse model together and refuses contradictions
// (repeated or dangling ids), but for tracks that name images which are no
// longer there: those elements are left out and counted. The binary and the
// text reader feed it in this order: cameras, images, rigs, frames, points.
// Errors are raised at the cursor of the record.
#pragma once

#include "colmap_plugin/formats/input_file.h"
#include "colmap_plugin/formats/sparse_model.h"

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

struct FrameData {
  SensorId sensor;
  uint64_t id = 0;  // of a camera: the image id

  bool operator<(const FrameData& other) const {
    return std::pair(sensor, id) < std::pair(other.sensor, other.id);
  }
};

class SparseModelBuilder {
 public:
  void AddCamera(const InputCursor& cursor, uint32_t id, SparseCamera camera);

  // rotation: w, x, y, z as in the file.
  void AddImage(const InputCursor& cursor,
                uint32_t id,
                const double rotation[4],
                const double translation[3],
                uint32_t camera_id,
                std::string name);

  void AddRig(const InputCursor& cursor,
              uint32_t id,
              std::set<SensorId> sensors);

  void AddFrame(const InputCursor& cursor,
                uint32_t id,
                uint32_t rig_id,
                const std::set<FrameData>& data);

  // After the last frame: puts the images into the order of the frames.
  // A model without rigs and frames keeps the order of its images file.
  void ApplyFrames(const InputCursor& cursor);

  void AddPoint(const InputCursor& cursor,
                uint64_t id,
                const Eigen::Vector3d& xyz,
                const std::vector<uint32_t>& track_image_ids);

  // After the last point.
  void CheckPointIds(const InputCursor& cursor);

  SparseModel Release() { return std::move(model_); }

 private:
  SparseModel model_;
  std::unordered_map<uint32_t, int> image_index_;
  std::map<uint32_t, std::set<SensorId>> rigs_;
  std::set<uint32_t> frame_ids_;
  std::vector<uint32_t> frame_image_ids_;  // in frame order
  std::set<uint32_t> images_in_frames_;
  std::vector<std::pair<uint64_t, uint64_t>>
      point_ids_;  // id, place in the file
};

}  // namespace hpm
