#include "colmap_plugin/formats/map_file.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/grid_header.h"
#include "colmap_plugin/formats/input_file.h"
#include "src/base/error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace hpm {
namespace {

// The number of values, checked by divisions so that no product can overflow.
uint64_t CheckedNumValues(const InputFile& file, const GridHeader& header) {
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
  return num_bytes / sizeof(float);
}

void CheckWritable(const std::filesystem::path& path, const Map& map) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::kFailure,
                fmt::format("refused to write {}: {}; please report this",
                            path.string(),
                            what));
  };
  if (map.width <= 0 || map.height <= 0 || map.channels <= 0)
    fail("the map has no size");
  const size_t num_pixels =
      static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  if (map.data.size() / num_pixels != static_cast<size_t>(map.channels) ||
      map.data.size() % num_pixels != 0) {
    fail("the number of values does not match the size");
  }
  const auto bad =
      std::find_if_not(map.data.begin(), map.data.end(), [](float value) {
        return std::isfinite(value);
      });
  if (bad != map.data.end()) {
    const size_t pixel =
        static_cast<size_t>(bad - map.data.begin()) % num_pixels;
    const size_t width = static_cast<size_t>(map.width);
    fail(fmt::format("the value at column {}, row {} is not finite",
                     pixel % width,
                     pixel / width));
  }
}

}  // namespace

MapHeader ReadMapHeader(const std::filesystem::path& path) {
  const InputFile file(path);
  const GridHeader header = ReadGridHeader(file);
  CheckedNumValues(file, header);
  return {header.width, header.height, header.channels};
}

Map ReadMap(const std::filesystem::path& path) {
  const InputFile file(path);
  const GridHeader header = ReadGridHeader(file);
  const uint64_t num_values = CheckedNumValues(file, header);
  Map map{header.width,
          header.height,
          header.channels,
          std::vector<float>(num_values)};
  const size_t num_bytes = num_values * sizeof(float);
  if (file.ReadAt(header.num_bytes, map.data.data(), num_bytes) != num_bytes) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{} became shorter while it was read; run again",
                            path.string()));
  }
  return map;
}

void WriteMap(const std::filesystem::path& path, const Map& map) {
  CheckWritable(path, map);
  AtomicFile file(path);
  file.Write(FormatGridHeader(map.width, map.height, map.channels));
  file.Write(map.data.data(), map.data.size() * sizeof(float));
  file.Commit();
}

}  // namespace hpm
