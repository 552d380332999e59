#include "tests/scenes/sparse_writer.h"

#include "src/base/error.h"
#include "tests/scenes/render.h"

#include <cmath>
#include <fstream>
#include <string>

#include <Eigen/Geometry>

namespace hpm {
namespace {

class BinaryFile {
 public:
  explicit BinaryFile(const std::filesystem::path& path)
      : path_(path), stream_(path, std::ios::binary) {}

  template <typename T>
  void Write(T value) {
    stream_.write(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  void WriteName(const std::string& name) {
    stream_.write(name.c_str(), static_cast<std::streamsize>(name.size() + 1));
  }
  void Close() {
    stream_.close();
    if (!stream_)
      throw Error(ErrorCode::kFailure, path_.string() + ": cannot be written");
  }

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

// The observation of `point` by a view, if it is inside of the picture and
// nothing stands before it.
bool Observe(const TestScene& scene,
             int view,
             const Eigen::Vector3d& point,
             Observation* out) {
  const Camera& camera = scene.cameras[view];
  const Vec3f p = CamFromWorld(camera,
                               {static_cast<float>(point.x()),
                                static_cast<float>(point.y()),
                                static_cast<float>(point.z())});
  if (!(p.z > 0)) return false;
  const double col = camera.fx * p.x / p.z + camera.cx;
  const double row = camera.fy * p.y / p.z + camera.cy;
  if (!(col > -0.5 && col < camera.width - 0.5 && row > -0.5 &&
        row < camera.height - 0.5)) {
    return false;
  }
  const std::optional<Hit> hit = HitAt(scene, camera, col, row);
  if (!hit || std::abs(hit->t - p.z) > 1e-4 * p.z) return false;
  *out = {view, col + 0.5, row + 0.5};
  return true;
}

}  // namespace

std::vector<TrackedPoint> SampleSurface(const TestScene& scene, int per_view) {
  std::vector<TrackedPoint> points;
  for (const Camera& camera : scene.cameras) {
    const double step =
        std::sqrt(static_cast<double>(camera.width) * camera.height / per_view);
    for (double row = step / 2; row < camera.height; row += step) {
      for (double col = step / 2; col < camera.width; col += step) {
        const std::optional<Hit> hit = HitAt(scene, camera, col, row);
        if (!hit) continue;
        TrackedPoint point{hit->point, {}};
        for (size_t view = 0; view < scene.cameras.size(); ++view) {
          Observation observation;
          if (Observe(
                  scene, static_cast<int>(view), hit->point, &observation)) {
            point.track.push_back(observation);
          }
        }
        if (point.track.size() >= 2) points.push_back(std::move(point));
      }
    }
  }
  return points;
}

void WriteSparseModel(const std::filesystem::path& folder,
                      const std::vector<Camera>& cameras,
                      const std::vector<std::string>& names,
                      const std::vector<TrackedPoint>& points) {
  std::filesystem::create_directories(folder);
  BinaryFile camera_file(folder / "cameras.bin");
  camera_file.Write<uint64_t>(cameras.size());
  for (size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    camera_file.Write<uint32_t>(static_cast<uint32_t>(i + 1));
    camera_file.Write<int32_t>(1);  // PINHOLE
    camera_file.Write<uint64_t>(static_cast<uint64_t>(camera.width));
    camera_file.Write<uint64_t>(static_cast<uint64_t>(camera.height));
    camera_file.Write<double>(camera.fx);
    camera_file.Write<double>(camera.fy);
    camera_file.Write<double>(camera.cx + 0.5);
    camera_file.Write<double>(camera.cy + 0.5);
  }
  camera_file.Close();

  struct Feature {
    Observation observation;
    uint64_t point_id;
  };
  std::vector<std::vector<Feature>> features(cameras.size());
  BinaryFile point_file(folder / "points3D.bin");
  point_file.Write<uint64_t>(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    point_file.Write<uint64_t>(i + 1);
    for (int axis = 0; axis < 3; ++axis)
      point_file.Write<double>(points[i].xyz[axis]);
    for (int channel = 0; channel < 3; ++channel)
      point_file.Write<uint8_t>(128);
    point_file.Write<double>(0.1);  // reprojection error
    point_file.Write<uint64_t>(points[i].track.size());
    for (const Observation& observation : points[i].track) {
      std::vector<Feature>& list = features[observation.view];
      point_file.Write<uint32_t>(static_cast<uint32_t>(observation.view + 1));
      point_file.Write<uint32_t>(static_cast<uint32_t>(list.size()));
      list.push_back({observation, i + 1});
    }
  }
  point_file.Close();

  BinaryFile image_file(folder / "images.bin");
  image_file.Write<uint64_t>(cameras.size());
  for (size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>
        rotation(camera.R.m);
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(Eigen::Matrix3d(rotation.cast<double>()))
            .normalized();
    image_file.Write<uint32_t>(static_cast<uint32_t>(i + 1));
    for (const double value : {q.w(), q.x(), q.y(), q.z()})
      image_file.Write<double>(value);
    for (const float value : {camera.t.x, camera.t.y, camera.t.z})
      image_file.Write<double>(value);
    image_file.Write<uint32_t>(static_cast<uint32_t>(i + 1));
    image_file.WriteName(names[i]);
    image_file.Write<uint64_t>(features[i].size());
    for (const Feature& feature : features[i]) {
      image_file.Write<double>(feature.observation.x);
      image_file.Write<double>(feature.observation.y);
      image_file.Write<uint64_t>(feature.point_id);
    }
  }
  image_file.Close();
}

}  // namespace hpm
