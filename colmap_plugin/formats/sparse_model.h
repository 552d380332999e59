// COLMAP's sparse model (cameras, images, points3D; binary or text, with or
// without rigs and frames), read strictly: counts are checked against the bytes
// that are left before anything is allocated, and every error names file and
// offset (binary) or line (text).
// Not checked here: image names (image_name.h), repeated names, focal lengths.
#pragma once

#include "src/base/cancel.h"
#include "src/base/huge_pages.h"
#include "src/base/log.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hpm {

// Intrinsics as in the model: the centre of pixel (col, row) is (col + 0.5, row
// + 0.5).
struct SparseCamera {
  std::string model;           // COLMAP's name, e.g. "PINHOLE"
  uint64_t width = 0;          // 1 ... 2^31 - 1
  uint64_t height = 0;         // 1 ... 2^31 - 1
  std::vector<double> params;  // as many as the model has; may be non-finite
};

struct SparseImage {
  uint32_t id = 0;
  std::string name;  // relative path below images/, with '/' and extension
  uint32_t camera_id = 0;
  // Normalised; all NaN if the file's quaternion is zero or not finite.
  Eigen::Quaterniond cam_from_world_rotation;
  Eigen::Vector3d
      cam_from_world_translation;  // as in the file, may be non-finite
};

// Image index (see SparseModel::images) per element, ascending, repeats kept.
class SparseTrack {
 public:
  using value_type = int;
  using const_iterator = const int*;
  SparseTrack(const int* begin, const int* end) : begin_(begin), end_(end) {}
  const int* begin() const { return begin_; }
  const int* end() const { return end_; }
  size_t size() const { return static_cast<size_t>(end_ - begin_); }
  bool empty() const { return begin_ == end_; }

 private:
  const int* begin_;
  const int* end_;
};

// As long as the model lives and no point is added.
struct SparsePoint {
  const Eigen::Vector3d& xyz;  // finite
  SparseTrack track;
};

// Models have millions of points with dozens of track elements each: they lie
// in three arrays, without memory of their own.
class SparsePoints {
 public:
  size_t size() const { return xyz_.size(); }
  bool empty() const { return xyz_.empty(); }
  SparsePoint operator[](size_t i) const {
    const int* elements = elements_.data();
    return {xyz_[i], {elements + begin_[i], elements + begin_[i + 1]}};
  }
  void Reserve(size_t num_points, size_t num_elements) {
    xyz_.reserve(num_points);
    begin_.reserve(num_points + 1);
    elements_.reserve(num_elements);
  }
  // The track may have any order.
  void Add(const Eigen::Vector3d& xyz, const std::vector<int>& track) {
    const auto added =
        elements_.insert(elements_.end(), track.begin(), track.end());
    std::sort(added, elements_.end());
    begin_.push_back(elements_.size());
    xyz_.push_back(xyz);
  }

 private:
  template <class T>
  using Array = std::vector<T, HugePageAllocator<T>>;
  Array<Eigen::Vector3d> xyz_;
  Array<size_t> begin_ = {0};  // of each track; behind them the end
  Array<int> elements_;
};

struct SparseModel {
  std::map<uint32_t, SparseCamera>
      cameras;  // every image's camera is among them
  // The position in this vector is COLMAP's image index (log lines, consistency
  // graphs, fused.ply.vis): file order, or frame order where frames exist.
  std::vector<SparseImage> images;
  SparsePoints points;  // those with non-finite coordinates are left out
  // Track elements in the file, and those among them of images that the model
  // does not have (filtered out by a script): they are in no track.
  uint64_t num_observations = 0;
  uint64_t num_left_out = 0;
  uint32_t left_out_example = 0;  // an image id, if there are any
};

// Reads the binary files if all three exist, else the text files. Where rigs.*
// and frames.* exist they give the order and the poses of the images, as in
// COLMAP; a warning in `log` says if images.* holds other poses. Text
// names may hold blanks: the whole rest of the line is the name (COLMAP cuts it
// at the first blank). A last image without its line of points is kept, too.
// Throws Error(kBadInput) naming the file at fault, Error(kInterrupted).
SparseModel ReadSparseModel(const std::filesystem::path& folder,
                            const LogSink& log = nullptr,
                            const CancelToken& cancel = {});

}  // namespace hpm
