#include "colmap_plugin/formats/map_file.h"

#include "colmap_plugin/formats/grid_header.h"
#include "src/base/error.h"
#include "src/base/retries.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include <fmt/format.h>

namespace hpm {
namespace {

// By divisions, so that no product can overflow.
void CheckNumValues(const InputFile& file, const GridHeader& header) {
  const uint64_t num_bytes = file.size() - header.num_bytes;
  uint64_t num_values = num_bytes / sizeof(float);
  bool fits = num_bytes % sizeof(float) == 0;
  for (const int size : {header.width, header.height, header.channels}) {
    fits = fits && num_values % static_cast<uint64_t>(size) == 0;
    num_values /= static_cast<uint64_t>(size);
  }
  if (!fits || num_values != 1) {
    throw Error(
        ErrorCode::kBadInput,
        fmt::format(
            "{} has {} bytes of data, which does not match its size {}x{}x{}; "
            "delete it and run again",
            file.path().string(),
            num_bytes,
            header.width,
            header.height,
            header.channels));
  }
}

[[noreturn]] void RefuseToWrite(const std::filesystem::path& path,
                                const std::string& what) {
  throw Error(
      ErrorCode::kFailure,
      fmt::format(
          "refused to write {}: {}; please report this", path.string(), what));
}

void CheckSize(const std::filesystem::path& path, const Map& map) {
  if (map.width <= 0 || map.height <= 0 || map.channels <= 0)
    RefuseToWrite(path, "the map has no size");
  const size_t num_pixels =
      static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  if (map.data.size() / num_pixels != static_cast<size_t>(map.channels) ||
      map.data.size() % num_pixels != 0) {
    RefuseToWrite(path, "the number of values does not match the size");
  }
}

// The checksum of a map is the hash of its header and of the hashes of its
// rows, so that rows may be written in any order.
PieceHash HashRow(const float* values, int width) {
  return HashPiece(values, static_cast<size_t>(width) * sizeof(float));
}

// Without a branch, so that the compiler looks at several at once.
bool AreFinite(const float* values, size_t count) {
  constexpr uint32_t kExponent = 0x7f800000;
  uint32_t num_others = 0;
  for (size_t i = 0; i < count; ++i) {
    uint32_t bits;
    std::memcpy(&bits, &values[i], sizeof(bits));
    num_others |= (bits & kExponent) == kExponent;
  }
  return num_others == 0;
}

}  // namespace

MapReader::MapReader(const std::filesystem::path& path) : file_(path) {
  const GridHeader header = ReadGridHeader(file_);
  CheckNumValues(file_, header);
  header_ = {header.width, header.height, header.channels};
  header_bytes_ = header.num_bytes;
}

void MapReader::ReadRows(int channel,
                         int row,
                         int num_rows,
                         float* values) const {
  const uint64_t row_bytes = uint64_t{sizeof(float)} * header_.width;
  const uint64_t first_row = uint64_t{1} * channel * header_.height + row;
  const uint64_t num_bytes = num_rows * row_bytes;
  if (file_.ReadAt(header_bytes_ + first_row * row_bytes, values, num_bytes) !=
      num_bytes) {
    throw UnreadableFile(
        fmt::format("{} became shorter while it was read; run again",
                    file_.path().string()));
  }
}

std::string MapReader::Checksum(const CancelToken& cancel) const {
  std::string text(header_bytes_, '\0');
  text.resize(file_.ReadAt(0, text.data(), text.size()));
  ContentHash hash;
  hash.Add(text.data(), text.size());
  constexpr int kPartValues = 1 << 16;
  const int part_rows =
      std::clamp(kPartValues / header_.width, 1, header_.height);
  std::vector<float> values(static_cast<size_t>(part_rows) * header_.width);
  for (int channel = 0; channel < header_.channels; ++channel) {
    for (int row = 0; row < header_.height; row += part_rows) {
      cancel.ThrowIfCancelled();
      const int num_rows = std::min(part_rows, header_.height - row);
      ReadRows(channel, row, num_rows, values.data());
      for (int i = 0; i < num_rows; ++i) {
        const PieceHash row_hash = HashRow(
            &values[static_cast<size_t>(i) * header_.width], header_.width);
        hash.Add(&row_hash, sizeof(row_hash));
      }
    }
  }
  return hash.Hex();
}

MapHeader ReadMapHeader(const std::filesystem::path& path) {
  return MapReader(path).header();
}

Map ReadMap(const std::filesystem::path& path) {
  const MapReader reader(path);
  const auto [width, height, channels] = reader.header();
  const size_t num_pixels = static_cast<size_t>(width) * height;
  Map map{width, height, channels, std::vector<float>(num_pixels * channels)};
  for (int channel = 0; channel < channels; ++channel)
    reader.ReadRows(channel, 0, height, &map.data[channel * num_pixels]);
  return map;
}

MapWriter::MapWriter(const std::filesystem::path& path,
                     const MapHeader& header,
                     Durability durability)
    : path_(path),
      header_(header),
      row_hashes_(static_cast<size_t>(header.height) * header.channels),
      file_(path, durability) {
  const std::string text =
      FormatGridHeader(header.width, header.height, header.channels);
  header_bytes_ = text.size();
  file_.Write(text);
  hash_.Add(text.data(), text.size());
}

void MapWriter::WriteRows(int channel,
                          int row,
                          int num_rows,
                          const float* values) {
  const size_t width = header_.width;
  const size_t count = num_rows * width;
  if (!AreFinite(values, count)) {
    const auto bad = static_cast<size_t>(
        std::find_if_not(values,
                         values + count,
                         [](float value) { return std::isfinite(value); }) -
        values);
    RefuseToWrite(path_,
                  fmt::format("the value at column {}, row {} is not finite",
                              bad % width,
                              row + bad / width));
  }
  const uint64_t first_row = uint64_t{1} * channel * header_.height + row;
  file_.WriteAt(header_bytes_ + first_row * width * sizeof(float),
                values,
                count * sizeof(float));
  for (int i = 0; i < num_rows; ++i)
    row_hashes_[first_row + i] = HashRow(values + i * width, header_.width);
}

PublishedFile MapWriter::Commit() {
  const FileState state = file_.Commit();
  hash_.Add(row_hashes_.data(), row_hashes_.size() * sizeof(PieceHash));
  return {state, hash_.Hex()};
}

PublishedFile WriteMap(const std::filesystem::path& path, const Map& map) {
  CheckSize(path, map);
  const size_t num_pixels = map.data.size() / map.channels;
  return RetryWriting([&] {
    MapWriter writer(path, {map.width, map.height, map.channels});
    for (int channel = 0; channel < map.channels; ++channel) {
      writer.WriteRows(
          channel, 0, map.height, map.data.data() + channel * num_pixels);
    }
    return writer.Commit();
  });
}

}  // namespace hpm
