// Little-endian records behind a count, without padding.
#include "colmap_plugin/formats/byte_reader.h"
#include "colmap_plugin/formats/camera_models.h"
#include "colmap_plugin/formats/sparse_model_io.h"

#include <limits>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr uint64_t kPoseBytes = 7 * sizeof(double);

// At the start of the file; checked against the bytes that follow.
uint64_t ReadCount(ByteReader* reader,
                   uint64_t min_record_bytes,
                   const char* what) {
  reader->BeginRecord();
  const auto num_records = reader->Read<uint64_t>();
  reader->CheckCount(num_records, min_record_bytes, what);
  return num_records;
}

// Calls read_record(&reader) so many times.
template <class ReadRecord>
void ReadEach(ByteReader* reader,
              uint64_t num_records,
              ReadRecord read_record) {
  for (uint64_t i = 0; i < num_records; ++i) {
    reader->BeginRecord();
    read_record(reader);
  }
  reader->CheckAtEnd();
}

template <class ReadRecord>
void ReadRecords(ByteReader* reader,
                 uint64_t min_record_bytes,
                 const char* what,
                 ReadRecord read_record) {
  ReadEach(reader, ReadCount(reader, min_record_bytes, what), read_record);
}

PoseRecord ReadPose(ByteReader* reader) {
  PoseRecord pose;
  for (double& value : pose.rotation) value = reader->Read<double>();
  for (double& value : pose.translation) value = reader->Read<double>();
  return pose;
}

SensorId ReadSensorId(ByteReader* reader) {
  SensorId sensor;
  sensor.type = reader->Read<int32_t>();
  sensor.id = reader->Read<uint32_t>();
  if (sensor.type != kCameraSensor && sensor.type != kImuSensor) {
    reader->Fail(fmt::format("unknown sensor type {}", sensor.type));
  }
  return sensor;
}

}  // namespace

void ReadCamerasBinary(const std::filesystem::path& path,
                       SparseModelBuilder* builder) {
  ByteReader file(path);
  ReadRecords(&file, 24, "cameras", [builder](ByteReader* reader) {
    const auto id = reader->Read<uint32_t>();
    const auto model_id = reader->Read<int32_t>();
    const CameraModelInfo* model = FindCameraModel(model_id);
    if (model == nullptr)
      reader->Fail(fmt::format("unknown camera model id {}", model_id));
    SparseCamera camera;
    camera.model = model->name;
    camera.width = reader->Read<uint64_t>();
    camera.height = reader->Read<uint64_t>();
    for (int i = 0; i < model->num_params; ++i)
      camera.params.push_back(reader->Read<double>());
    builder->AddCamera(*reader, id, std::move(camera));
  });
}

void ReadImagesBinary(const std::filesystem::path& path,
                      SparseModelBuilder* builder) {
  ByteReader file(path);
  ReadRecords(&file,
              4 + kPoseBytes + 4 + 1 + 8,
              "images",
              [builder](ByteReader* reader) {
                const auto id = reader->Read<uint32_t>();
                const PoseRecord cam_from_world = ReadPose(reader);
                const auto camera_id = reader->Read<uint32_t>();
                std::string name = reader->ReadName();
                constexpr uint64_t kPoint2DBytes =
                    2 * sizeof(double) + sizeof(uint64_t);
                const auto num_points2D = reader->Read<uint64_t>();
                reader->CheckCount(num_points2D, kPoint2DBytes, "image points");
                reader->Skip(num_points2D * kPoint2DBytes);
                builder->AddImage(
                    *reader, id, cam_from_world, camera_id, std::move(name));
              });
}

void ReadRigsBinary(const std::filesystem::path& path,
                    SparseModelBuilder* builder) {
  ByteReader file(path);
  ReadRecords(&file, 8, "rigs", [builder](ByteReader* reader) {
    const auto id = reader->Read<uint32_t>();
    const auto num_sensors = reader->Read<uint32_t>();
    reader->CheckCount(num_sensors, 8, "sensors");
    std::vector<RigSensor> sensors;
    for (uint32_t i = 0; i < num_sensors; ++i) {
      RigSensor sensor;
      sensor.id = ReadSensorId(reader);
      if (i == 0) {  // the reference sensor: the file holds no pose
        sensor.sensor_from_rig = PoseRecord();
      } else if (reader->Read<uint8_t>() != 0) {
        sensor.sensor_from_rig = ReadPose(reader);
      }
      sensors.push_back(sensor);
    }
    builder->AddRig(*reader, id, sensors);
  });
}

void ReadFramesBinary(const std::filesystem::path& path,
                      SparseModelBuilder* builder) {
  ByteReader file(path);
  ReadRecords(
      &file, 8 + kPoseBytes + 4, "frames", [builder](ByteReader* reader) {
        const auto id = reader->Read<uint32_t>();
        const auto rig_id = reader->Read<uint32_t>();
        const PoseRecord rig_from_world = ReadPose(reader);
        const auto num_data = reader->Read<uint32_t>();
        reader->CheckCount(num_data, 16, "data ids");
        std::set<FrameData> data;
        for (uint32_t i = 0; i < num_data; ++i) {
          const SensorId sensor = ReadSensorId(reader);
          data.insert({sensor, reader->Read<uint64_t>()});
        }
        builder->AddFrame(*reader, id, rig_id, rig_from_world, data);
      });
  builder->ApplyFrames(file);
}

void ReadPointsBinary(const std::filesystem::path& path,
                      SparseModelBuilder* builder) {
  ByteReader file(path);
  constexpr uint64_t kBytesWithoutTrack = 51, kElementBytes = 8;
  const uint64_t num_points = ReadCount(&file, kBytesWithoutTrack, "points");
  builder->ReservePoints(
      num_points,
      (file.Remaining() - kBytesWithoutTrack * num_points) / kElementBytes);
  std::vector<uint32_t> track;
  ReadEach(&file, num_points, [builder, &track](ByteReader* reader) {
    const auto id = reader->Read<uint64_t>();
    Eigen::Vector3d xyz;
    for (int i = 0; i < 3; ++i) xyz[i] = reader->Read<double>();
    reader->Skip(3 + sizeof(double));  // colour and reprojection error
    const auto track_length = reader->Read<uint64_t>();
    reader->CheckCount(track_length, kElementBytes, "track elements");
    track.clear();
    for (uint64_t i = 0; i < track_length; ++i) {
      track.push_back(reader->Read<uint32_t>());
      reader->Skip(sizeof(uint32_t));  // index of the image point
    }
    builder->AddPoint(*reader, id, xyz, track);
  });
  builder->CheckPointIds(file);
}

}  // namespace hpm
