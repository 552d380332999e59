// One record per line ('#' begins a comment line), images on two lines.
#include "colmap_plugin/formats/camera_models.h"
#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/sparse_model_io.h"
#include "colmap_plugin/formats/text_reader.h"

#include <fmt/format.h>

namespace hpm {
namespace {

// Moves to the next line that is neither empty nor a comment.
bool NextRecord(LineReader* lines) {
  while (lines->Next()) {
    if (!lines->line().empty() && lines->line().front() != '#') return true;
  }
  return false;
}

void CheckAtEnd(const LineReader& lines, const Words& words) {
  if (!words.AtEnd()) lines.Fail("the line has too many words");
}

void ReadNumbers(const LineReader& lines,
                 Words* words,
                 double* values,
                 int count,
                 const char* what) {
  for (int i = 0; i < count; ++i)
    values[i] = ReadNumber<double>(lines, words, what);
}

PoseRecord ReadPose(const LineReader& lines, Words* words) {
  PoseRecord pose;
  ReadNumbers(lines, words, pose.rotation, 4, "a quaternion");
  ReadNumbers(lines, words, pose.translation, 3, "a translation");
  return pose;
}

SensorId ReadSensorId(const LineReader& lines, Words* words) {
  SensorId sensor;
  const std::string_view type = words->Next();
  if (type == "CAMERA") {
    sensor.type = kCameraSensor;
  } else if (type == "IMU") {
    sensor.type = kImuSensor;
  } else {
    lines.Fail(fmt::format("unknown sensor type {}", QuotedName(type)));
  }
  sensor.id = ReadNumber<uint32_t>(lines, words, "a sensor id");
  return sensor;
}

bool ReadHasPose(const LineReader& lines, Words* words) {
  const std::string_view word = words->Next();
  if (word != "0" && word != "1") {
    lines.Fail("expected 0 or 1 for whether the sensor has a pose");
  }
  return word == "1";
}

}  // namespace

void ReadCamerasText(const std::filesystem::path& path,
                     SparseModelBuilder* builder) {
  LineReader lines(path);
  while (NextRecord(&lines)) {
    Words words(lines.line());
    const auto id = ReadNumber<uint32_t>(lines, &words, "a camera id");
    const std::string_view model_name = words.Next();
    const CameraModelInfo* model = FindCameraModel(model_name);
    if (model == nullptr) {
      lines.Fail(
          fmt::format("unknown camera model {}", QuotedName(model_name)));
    }
    SparseCamera camera;
    camera.model = model->name;
    camera.width = ReadNumber<uint64_t>(lines, &words, "the width");
    camera.height = ReadNumber<uint64_t>(lines, &words, "the height");
    camera.params.resize(static_cast<size_t>(model->num_params));
    ReadNumbers(lines,
                &words,
                camera.params.data(),
                model->num_params,
                "a camera parameter");
    CheckAtEnd(lines, words);
    builder->AddCamera(lines, id, std::move(camera));
  }
}

void ReadImagesText(const std::filesystem::path& path,
                    SparseModelBuilder* builder) {
  LineReader lines(path);
  while (NextRecord(&lines)) {
    Words words(lines.line());
    const auto id = ReadNumber<uint32_t>(lines, &words, "an image id");
    const PoseRecord cam_from_world = ReadPose(lines, &words);
    const auto camera_id = ReadNumber<uint32_t>(lines, &words, "a camera id");
    builder->AddImage(
        lines, id, cam_from_world, camera_id, std::string(words.Rest()));

    // The line of image points is not needed, but an image line in its place
    // would be lost: points come in threes (x, y, point id) and hold numbers
    // only.
    if (!lines.Next()) break;
    Words points(lines.line());
    while (!points.AtEnd()) {
      double xy[2];
      ReadNumbers(lines,
                  &points,
                  xy,
                  2,
                  "the points of the image above (x, y and point id each; an "
                  "empty line if it has none)");
      // -1 or 2^64 - 1 stands for none.
      ReadNumber<double>(lines, &points, "a point id");
    }
  }
}

void ReadRigsText(const std::filesystem::path& path,
                  SparseModelBuilder* builder) {
  LineReader lines(path);
  while (NextRecord(&lines)) {
    Words words(lines.line());
    const auto id = ReadNumber<uint32_t>(lines, &words, "a rig id");
    const auto num_sensors =
        ReadNumber<uint32_t>(lines, &words, "a number of sensors");
    std::vector<RigSensor> sensors;
    for (uint32_t i = 0; i < num_sensors; ++i) {
      RigSensor sensor;
      sensor.id = ReadSensorId(lines, &words);
      if (i == 0) {  // the reference sensor: the file holds no pose
        sensor.sensor_from_rig = PoseRecord();
      } else if (ReadHasPose(lines, &words)) {
        sensor.sensor_from_rig = ReadPose(lines, &words);
      }
      sensors.push_back(sensor);
    }
    CheckAtEnd(lines, words);
    builder->AddRig(lines, id, sensors);
  }
}

void ReadFramesText(const std::filesystem::path& path,
                    SparseModelBuilder* builder) {
  LineReader lines(path);
  while (NextRecord(&lines)) {
    Words words(lines.line());
    const auto id = ReadNumber<uint32_t>(lines, &words, "a frame id");
    const auto rig_id = ReadNumber<uint32_t>(lines, &words, "a rig id");
    const PoseRecord rig_from_world = ReadPose(lines, &words);
    const auto num_data =
        ReadNumber<uint32_t>(lines, &words, "a number of data ids");
    std::set<FrameData> data;
    for (uint32_t i = 0; i < num_data; ++i) {
      const SensorId sensor = ReadSensorId(lines, &words);
      data.insert({sensor, ReadNumber<uint64_t>(lines, &words, "a data id")});
    }
    CheckAtEnd(lines, words);
    builder->AddFrame(lines, id, rig_id, rig_from_world, data);
  }
  builder->ApplyFrames(lines);
}

void ReadPointsText(const std::filesystem::path& path,
                    SparseModelBuilder* builder) {
  LineReader lines(path);
  std::vector<uint32_t> track;
  while (NextRecord(&lines)) {
    Words words(lines.line());
    const auto id = ReadNumber<uint64_t>(lines, &words, "a point id");
    double xyz[3];
    double color_and_error[4];
    ReadNumbers(lines, &words, xyz, 3, "a coordinate");
    ReadNumbers(lines, &words, color_and_error, 4, "a colour or error");
    track.clear();
    while (!words.AtEnd()) {
      track.push_back(ReadNumber<uint32_t>(lines, &words, "an image id"));
      ReadNumber<uint32_t>(lines, &words, "the index of an image point");
    }
    builder->AddPoint(
        lines, id, Eigen::Vector3d(xyz[0], xyz[1], xyz[2]), track);
  }
  builder->CheckPointIds(lines);
}

}  // namespace hpm
