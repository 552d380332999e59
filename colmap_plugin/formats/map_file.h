// Depth and normal maps in COLMAP's layout: "<W>&<H>&<C>&" then little-endian
// float32, channel by channel, row by row.
#pragma once

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/content_hash.h"
#include "src/base/input_file.h"

#include <filesystem>
#include <vector>

namespace hpm {

// data[(channel * height + row) * width + col]. Depth maps have one channel
// (z in the camera frame, model units, 0 = none), normal maps three (unit,
// camera frame, toward the camera, 0 = none).
struct Map {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> data;
};

struct MapHeader {
  int width = 0;
  int height = 0;
  int channels = 0;
};

// Reads and checks the header: positive sizes and a file length of exactly
// header + 4*W*H*C bytes. Throws Error(kBadInput).
MapHeader ReadMapHeader(const std::filesystem::path& path);

// Reads a map in parts, which several threads may do at once.
class MapReader {
 public:
  // As ReadMapHeader.
  explicit MapReader(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return file_.path(); }
  const MapHeader& header() const { return header_; }

  // `values` has room for so many rows of one channel.
  void ReadRows(int channel, int row, int num_rows, float* values) const;

  // What the file's writer told, if nothing changed since. Throws
  // Error(kInterrupted), too.
  std::string Checksum(const CancelToken& cancel) const;

 private:
  InputFile file_;
  MapHeader header_;
  uint64_t header_bytes_;
};

// As ReadMapHeader, then the values; allocates only after the length is
// checked.
Map ReadMap(const std::filesystem::path& path);

// Writes a map in parts, which several threads may do at once; it appears when
// all are there (see atomic_file.h). Throws Error(kFailure) on values that are
// not finite, Error(kOutOfResources) on a full disk.
class MapWriter {
 public:
  MapWriter(const std::filesystem::path& path,
            const MapHeader& header,
            Durability durability = Durability::kPowerCut);

  // So many rows of one channel.
  void WriteRows(int channel, int row, int num_rows, const float* values);

  void Flush() { file_.Flush(); }
  PublishedFile Commit();

 private:
  std::filesystem::path path_;
  MapHeader header_;
  uint64_t header_bytes_;
  ContentHash hash_;
  std::vector<PieceHash> row_hashes_;  // channel by channel
  AtomicFile file_;
};

// Atomic: writes a temporary file beside `path`, then renames (see
// atomic_file.h). Throws Error(kFailure) on non-finite values,
// Error(kOutOfResources) on a full disk.
PublishedFile WriteMap(const std::filesystem::path& path, const Map& map);

}  // namespace hpm
