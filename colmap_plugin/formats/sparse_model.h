// COLMAP's sparse model (cameras, images, points3D; binary or text, with or
// without rigs and frames), read strictly: counts are checked against the bytes
// that are left before anything is allocated, and every error names file and offset.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hpm {

// Intrinsics as in the model: the centre of pixel (col, row) is (col + 0.5, row + 0.5).
struct SparseCamera {
  std::string model;  // e.g. "PINHOLE"
  uint64_t width = 0;
  uint64_t height = 0;
  std::vector<double> params;
};

struct SparseImage {
  uint32_t id = 0;
  std::string name;  // relative path below images/, with '/' and extension
  uint32_t camera_id = 0;
  Eigen::Quaterniond cam_from_world_rotation;  // normalised
  Eigen::Vector3d cam_from_world_translation;
};

struct SparsePoint {
  Eigen::Vector3d xyz;
  std::vector<int> track;  // image index (see SparseModel::images) per track element, repeats kept
};

struct SparseModel {
  std::map<uint32_t, SparseCamera> cameras;
  // The position in this vector is COLMAP's image index (log lines, consistency
  // graphs, fused.ply.vis): file order, or frame order where frames exist.
  std::vector<SparseImage> images;
  std::vector<SparsePoint> points;
};

// Reads the binary files if all three exist, else the text files.
// Throws Error(kBadInput) naming the file at fault.
SparseModel ReadSparseModel(const std::filesystem::path& folder);

}  // namespace hpm
