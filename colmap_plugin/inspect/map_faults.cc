#include "colmap_plugin/inspect/map_faults.h"

#include "colmap_plugin/formats/consistency_graph.h"
#include "src/base/error.h"
#include "src/base/input_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <fmt/format.h>

namespace hpm {
namespace {

// float32 normals that were turned and written are one to six digits.
constexpr float kMaxLengthError = 1e-3f;
constexpr int kPartValues = 1 << 16;

// Without the name of the file, which the messages of the readers begin with.
std::string WithoutPath(const std::string& message,
                        const std::filesystem::path& path) {
  const std::string name = path.string();
  if (message.rfind(name, 0) != 0) return message;
  const size_t begin = message.find_first_not_of(" :", name.size());
  return begin == std::string::npos ? message : message.substr(begin);
}

// The first fault that `fault_at` finds at a pixel, given its values by
// channel.
std::string FirstFault(
    const std::filesystem::path& path,
    int num_channels,
    const std::function<std::string(const float* values)>& fault_at) {
  try {
    const MapReader reader(path);
    const auto [width, height, channels] = reader.header();
    if (channels != num_channels) {
      return fmt::format(
          "has {} channels in place of {}", channels, num_channels);
    }
    const int part_rows = std::clamp(kPartValues / width, 1, height);
    const size_t part = static_cast<size_t>(part_rows) * width;
    std::vector<float> values(part * channels);
    for (int row = 0; row < height; row += part_rows) {
      const int num_rows = std::min(part_rows, height - row);
      for (int channel = 0; channel < channels; ++channel)
        reader.ReadRows(channel, row, num_rows, &values[channel * part]);
      const size_t count = static_cast<size_t>(num_rows) * width;
      for (size_t i = 0; i < count; ++i) {
        float pixel[3] = {};
        for (int channel = 0; channel < channels; ++channel)
          pixel[channel] = values[channel * part + i];
        const std::string fault = fault_at(pixel);
        if (fault.empty()) continue;
        return fmt::format(
            "{} at column {}, row {}", fault, i % width, row + i / width);
      }
    }
  } catch (const UnreadableFile&) {
    throw;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kBadInput) throw;
    return WithoutPath(error.what(), path);
  }
  return "";
}

}  // namespace

std::string FaultOfDepths(const std::filesystem::path& path,
                          const DepthRange& range) {
  return FirstFault(path, 1, [&](const float* values) -> std::string {
    const float depth = values[0];
    if (!std::isfinite(depth)) return "a depth is not finite";
    if (depth < 0) return fmt::format("the depth {} is negative", depth);
    if (depth == 0 || (depth >= range.min && depth <= range.max)) return "";
    return fmt::format(
        "the depth {} is not in {} ... {}", depth, range.min, range.max);
  });
}

std::string FaultOfNormals(const std::filesystem::path& path) {
  return FirstFault(path, 3, [](const float* normal) -> std::string {
    const float length = std::sqrt(
        normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (!std::isfinite(length)) return "a normal is not finite";
    if (length == 0 || std::abs(length - 1) <= kMaxLengthError) return "";
    return fmt::format("a normal has the length {}", length);
  });
}

std::string FaultOfConfidence(const std::filesystem::path& path) {
  return FirstFault(path, 1, [](const float* value) -> std::string {
    if (*value >= 0 && *value <= 1) return "";
    return fmt::format("the confidence {} is not in 0 ... 1", *value);
  });
}

std::string FaultOfGraph(const std::filesystem::path& path, int num_images) {
  try {
    const ConsistencyGraph graph = ReadConsistencyGraph(path);
    for (size_t i = 0; i < graph.data.size();) {
      const size_t end = i + 3 + static_cast<size_t>(graph.data[i + 2]);
      for (i += 3; i < end; ++i) {
        if (graph.data[i] >= num_images) {
          return fmt::format(
              "names image {} of a model of {}", graph.data[i], num_images);
        }
      }
    }
  } catch (const UnreadableFile&) {
    throw;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kBadInput) throw;
    return WithoutPath(error.what(), path);
  }
  return "";
}

}  // namespace hpm
