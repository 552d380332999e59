#include "colmap_plugin/formats/exchange_files.h"

#include <cstring>
#include <type_traits>

#include <fmt/format.h>

namespace hpm {
namespace {

// Little-endian, as all machines are that this program runs on.
template <class T>
void Append(const T& value, std::string* to) {
  static_assert(std::is_trivially_copyable_v<T>, "bytes are the value");
  const size_t at = to->size();
  to->resize(at + sizeof(T));
  std::memcpy(to->data() + at, &value, sizeof(T));
}

void AppendFloats(const float* values, size_t count, std::string* to) {
  to->append(reinterpret_cast<const char*>(values), count * sizeof(float));
}

// An attribute of the header of an EXR file.
void AppendAttribute(const char* name,
                     const char* type,
                     const std::string& value,
                     std::string* to) {
  to->append(name, std::strlen(name) + 1);
  to->append(type, std::strlen(type) + 1);
  Append(static_cast<int32_t>(value.size()), to);
  *to += value;
}

template <class... T>
std::string BytesOf(const T&... values) {
  std::string bytes;
  (Append(values, &bytes), ...);
  return bytes;
}

std::string ExrHeader(const Map& map, const std::string& channels) {
  std::string list;
  for (const char channel : channels) {
    list += channel;
    list += '\0';
    // 32-bit float, not perceptually linear, three bytes of nothing, each pixel
    // in both directions.
    list += BytesOf(int32_t{2}, int32_t{0}, int32_t{1}, int32_t{1});
  }
  list += '\0';
  const std::string window = BytesOf(
      int32_t{0}, int32_t{0}, int32_t{map.width - 1}, int32_t{map.height - 1});
  std::string header = BytesOf(int32_t{20000630}, int32_t{2});
  AppendAttribute("channels", "chlist", list, &header);
  AppendAttribute("compression", "compression", BytesOf(uint8_t{0}), &header);
  AppendAttribute("dataWindow", "box2i", window, &header);
  AppendAttribute("displayWindow", "box2i", window, &header);
  AppendAttribute("lineOrder", "lineOrder", BytesOf(uint8_t{0}), &header);
  AppendAttribute("pixelAspectRatio", "float", BytesOf(1.0f), &header);
  AppendAttribute("screenWindowCenter", "v2f", BytesOf(0.0f, 0.0f), &header);
  AppendAttribute("screenWindowWidth", "float", BytesOf(1.0f), &header);
  return header + '\0';
}

size_t NumPixels(const Map& map) {
  return static_cast<size_t>(map.width) * map.height;
}

// The values of a row, channel after channel for each pixel.
void AppendInterleavedRow(const Map& map, int row, std::string* to) {
  for (int col = 0; col < map.width; ++col) {
    for (int channel = 0; channel < map.channels; ++channel) {
      Append(map.data[channel * NumPixels(map) +
                      static_cast<size_t>(row) * map.width + col],
             to);
    }
  }
}

}  // namespace

std::string EncodeExr(const Map& map) {
  // By the alphabet, as the format wants it.
  const std::string channels = map.channels == 1 ? "Y" : "BGR";
  std::string file = ExrHeader(map, channels);
  const size_t width = map.width;
  const size_t row_bytes = channels.size() * width * sizeof(float);
  const uint64_t block_bytes = 2 * sizeof(int32_t) + row_bytes;
  const uint64_t first = file.size() + sizeof(uint64_t) * map.height;
  for (int row = 0; row < map.height; ++row)
    Append(first + row * block_bytes, &file);
  for (int row = 0; row < map.height; ++row) {
    Append(int32_t{row}, &file);
    Append(static_cast<int32_t>(row_bytes), &file);
    for (int channel = map.channels - 1; channel >= 0; --channel) {
      AppendFloats(
          &map.data[channel * NumPixels(map) + row * width], width, &file);
    }
  }
  return file;
}

std::string EncodePfm(const Map& map) {
  std::string file = fmt::format("{}\n{} {}\n-1.0\n",
                                 map.channels == 1 ? "Pf" : "PF",
                                 map.width,
                                 map.height);
  for (int row = map.height - 1; row >= 0; --row)
    AppendInterleavedRow(map, row, &file);
  return file;
}

std::string EncodeNpy(const Map& map) {
  std::string header = fmt::format(
      "{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}{}), }}",
      map.height,
      map.width,
      map.channels == 1 ? "" : fmt::format(", {}", map.channels));
  // So that the values begin at a multiple of 64 bytes.
  constexpr size_t kBefore = 10;
  header.append(63 - (kBefore + header.size()) % 64, ' ');
  header += '\n';
  std::string file("\x93NUMPY\x01\x00", 8);
  Append(static_cast<uint16_t>(header.size()), &file);
  file += header;
  for (int row = 0; row < map.height; ++row)
    AppendInterleavedRow(map, row, &file);
  return file;
}

std::string EncodePly(const std::vector<CloudPoint>& points) {
  std::string file = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "end_header\n",
      points.size());
  for (const CloudPoint& point : points) {
    Append(point.position, &file);
    Append(point.normal, &file);
    Append(point.rgb, &file);
  }
  return file;
}

}  // namespace hpm
