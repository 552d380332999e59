// The smallest sparse model with everything in it, as the bytes of its files:
// two cameras, three images (ids 7, 3, 5 in file order), two points; optionally
// one rig with two cameras and two frames that put the images in the order 5,
// 7, 3 and give them the poses of the images file.
#pragma once

#include "tests/colmap_plugin/formats/test_files.h"

#include <array>
#include <map>
#include <string>

namespace hpm {

using ModelFiles = std::map<std::string, std::string>;  // file name -> bytes

inline std::string CameraRecord(uint32_t id,
                                int32_t model,
                                uint64_t width,
                                uint64_t height,
                                int num_params) {
  Bytes bytes;
  bytes.Add(id).Add(model).Add(width).Add(height);
  for (int i = 0; i < num_params; ++i) bytes.Add(100.0 + i);
  return bytes.str();
}

inline std::string ImageRecord(uint32_t id,
                               uint32_t camera_id,
                               std::string_view name,
                               double qw = 1) {
  Bytes bytes;
  bytes.Add(id).Add(qw).Add(0.0).Add(0.0).Add(0.0);
  bytes.Add(0.5).Add(-1.0).Add(2.0).Add(camera_id);
  bytes.Text(name).Text(std::string_view("\0", 1));
  bytes.Add(uint64_t{1}).Add(3.5).Add(4.5).Add(~uint64_t{0});
  return bytes.str();
}

inline std::string PointRecord(uint64_t id,
                               double x,
                               const std::vector<uint32_t>& track) {
  Bytes bytes;
  bytes.Add(id).Add(x).Add(2.0).Add(3.0).Text("rgb").Add(0.5);
  bytes.Add(uint64_t{track.size()});
  for (const uint32_t image_id : track) bytes.Add(image_id).Add(uint32_t{0});
  return bytes.str();
}

inline std::string Counted(uint64_t count, const std::string& records) {
  return Bytes().Add(count).str() + records;
}

inline ModelFiles TinyBinaryModel() {
  return {
      {"cameras.bin",
       Counted(2,
               CameraRecord(1, 1, 40, 30, 4) + CameraRecord(2, 0, 20, 10, 3))},
      {"images.bin",
       Counted(3,
               ImageRecord(7, 1, "a b.jpg", -2) + ImageRecord(3, 2, "c/d.jpg") +
                   ImageRecord(5, 1, "e.jpg"))},
      {"points3D.bin",
       Counted(2, PointRecord(9, 1, {7, 3, 7}) + PointRecord(4, -1, {5}))}};
}

inline ModelFiles TinyTextModel() {
  return {
      {"cameras.txt",
       "# Camera list\n1 PINHOLE 40 30 100 101 102 103\n"
       "\n2 SIMPLE_PINHOLE 20 10 100 101 102\n"},
      {"images.txt",
       "# Image list\n7 -2 0 0 0 0.5 -1 2 1 a b.jpg\n3.5 4.5 -1\n"
       "3 1 0 0 0 0.5 -1 2e0 2 c/d.jpg\n\n"
       "5 1 0 0 0 0.5 -1 2 1 e.jpg\n3.5 nan 4 1 2 -1\n"},
      {"points3D.txt",
       "# Points\n9 1 2 3 1 2 3 0.5 7 0 3 0 7 1\n4 -1 2 3 1 2 3 0.5 5 0\n"}};
}

// w, x, y, z, then the translation.
using TestPose = std::array<double, 7>;
constexpr TestPose kNoTurn = {1, 0, 0, 0, 0, 0, 0};

inline std::string PoseText(const TestPose& pose) {
  std::string text;
  for (const double value : pose) text += std::to_string(value) + " ";
  return text;
}

inline std::string FrameRecord(uint32_t id,
                               uint32_t rig_id,
                               const std::string& data,
                               uint32_t num_data) {
  Bytes bytes;
  bytes.Add(id).Add(rig_id);
  for (const double value : {1.0, 0.0, 0.0, 0.0, 0.5, -1.0, 2.0})
    bytes.Add(value);
  return bytes.Add(num_data).Text(data).str();
}

inline std::string DataRecord(int32_t type, uint32_t sensor_id, uint64_t id) {
  return Bytes().Add(type).Add(sensor_id).Add(id).str();
}

// camera_2: its pose in the rig.
inline std::string RigRecord(const TestPose& camera_2 = kNoTurn) {
  Bytes bytes;
  bytes.Add(uint32_t{1}).Add(uint32_t{3});
  bytes.Add(int32_t{0}).Add(uint32_t{1});  // reference: camera 1
  bytes.Add(int32_t{0})
      .Add(uint32_t{2})
      .Add(uint8_t{1});  // camera 2, with pose
  for (const double value : camera_2) bytes.Add(value);
  bytes.Add(int32_t{1}).Add(uint32_t{8}).Add(uint8_t{0});  // an IMU, without
  return bytes.str();
}

inline ModelFiles TinyRigFiles(const TestPose& camera_2 = kNoTurn) {
  return {{"rigs.bin", Counted(1, RigRecord(camera_2))},
          {"frames.bin",
           Counted(2,
                   FrameRecord(1, 1, DataRecord(0, 1, 5), 1) +
                       // Out of order: sorted by sensor, then by id.
                       FrameRecord(2,
                                   1,
                                   DataRecord(1, 8, 77) + DataRecord(0, 2, 3) +
                                       DataRecord(0, 1, 7),
                                   3))}};
}

inline ModelFiles TinyTextRigFiles(const TestPose& camera_2 = kNoTurn) {
  return {
      {"rigs.txt",
       "# Rigs\n1 3 CAMERA 1 CAMERA 2 1 " + PoseText(camera_2) + "IMU 8 0\n"},
      {"frames.txt",
       "# Frames\n1 1 1 0 0 0 0.5 -1 2 1 CAMERA 1 5\n"
       "2 1 1 0 0 0 0.5 -1 2 3 IMU 8 77 CAMERA 2 3 CAMERA 1 7\n"}};
}

inline ModelFiles Joined(ModelFiles a, const ModelFiles& b) {
  a.insert(b.begin(), b.end());
  return a;
}

inline void WriteModel(const std::filesystem::path& folder,
                       const ModelFiles& files) {
  for (const auto& [name, bytes] : files) WriteFile(folder / name, bytes);
}

}  // namespace hpm
