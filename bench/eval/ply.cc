#include "bench/eval/ply.h"

#include "src/base/error.h"

#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace hpm {
namespace {

struct Property {
  std::string type;
  size_t offset = 0;
};

struct Header {
  uint64_t num_vertices = 0;
  size_t stride = 0;
  std::map<std::string, Property> properties;
};

[[noreturn]] void Fail(const std::filesystem::path& path,
                       const std::string& what) {
  throw Error(ErrorCode::kBadInput, path.string() + ": " + what);
}

size_t SizeOfType(const std::filesystem::path& path, const std::string& type) {
  static const std::map<std::string, size_t> kSizes = {{"char", 1},
                                                       {"int8", 1},
                                                       {"uchar", 1},
                                                       {"uint8", 1},
                                                       {"short", 2},
                                                       {"int16", 2},
                                                       {"ushort", 2},
                                                       {"uint16", 2},
                                                       {"int", 4},
                                                       {"int32", 4},
                                                       {"uint", 4},
                                                       {"uint32", 4},
                                                       {"float", 4},
                                                       {"float32", 4},
                                                       {"double", 8},
                                                       {"float64", 8}};
  const auto it = kSizes.find(type);
  if (it == kSizes.end())
    Fail(path, "vertex property of type '" + type + "' cannot be read");
  return it->second;
}

Header ReadHeader(const std::filesystem::path& path, std::istream& stream) {
  Header header;
  bool in_vertex = false;
  bool seen_format = false;
  int num_elements = 0;
  std::string line;
  if (!std::getline(stream, line) || line.rfind("ply", 0) != 0)
    Fail(path, "is not a PLY file");
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string key, first, second;
    words >> key >> first >> second;
    if (key == "format") {
      if (first != "binary_little_endian") {
        Fail(path,
             "only binary_little_endian PLY can be read, this is " + first);
      }
      seen_format = true;
    } else if (key == "element") {
      ++num_elements;
      in_vertex = first == "vertex";
      if (in_vertex && num_elements != 1)
        Fail(path, "vertices must be the first element");
      if (in_vertex) {
        std::istringstream count(second);
        if (!(count >> header.num_vertices))
          Fail(path, "the number of vertices is unreadable");
      }
    } else if (key == "property" && in_vertex) {
      const size_t size = SizeOfType(path, first);
      header.properties[second] = {first, header.stride};
      header.stride += size;
    } else if (key == "end_header") {
      if (!seen_format || header.stride == 0)
        Fail(path, "the PLY header names no vertices");
      return header;
    }
  }
  Fail(path, "the PLY header has no end");
}

float ReadScalar(const char* vertex, const Property& property) {
  const char* at = vertex + property.offset;
  if (property.type == "double" || property.type == "float64") {
    double value;
    std::memcpy(&value, at, sizeof(value));
    return static_cast<float>(value);
  }
  float value;
  std::memcpy(&value, at, sizeof(value));
  return value;
}

// The three named properties, if all are there and are real numbers.
bool FindReals(const Header& header,
               const std::array<const char*, 3>& names,
               Property (&out)[3]) {
  for (int i = 0; i < 3; ++i) {
    const auto it = header.properties.find(names[i]);
    if (it == header.properties.end()) return false;
    const std::string& type = it->second.type;
    if (type.rfind("float", 0) != 0 && type != "double") return false;
    out[i] = it->second;
  }
  return true;
}

}  // namespace

PointCloud ReadPly(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) Fail(path, "cannot be opened");
  const Header header = ReadHeader(path, stream);
  const uint64_t begin = static_cast<uint64_t>(stream.tellg());
  const uint64_t left = std::filesystem::file_size(path) - begin;
  if (header.num_vertices > left / header.stride) {
    Fail(path,
         "is truncated: the header promises " +
             std::to_string(header.num_vertices) + " vertices");
  }
  Property xyz[3], normal[3];
  if (!FindReals(header, {"x", "y", "z"}, xyz))
    Fail(path, "has no vertex properties x, y, z");
  const bool has_normals = FindReals(header, {"nx", "ny", "nz"}, normal);
  Property rgb[3];
  bool has_colors = true;
  const std::array<const char*, 3> color_names = {"red", "green", "blue"};
  for (int i = 0; i < 3; ++i) {
    const auto it = header.properties.find(color_names[i]);
    has_colors = has_colors && it != header.properties.end() &&
                 (it->second.type == "uchar" || it->second.type == "uint8");
    if (has_colors) rgb[i] = it->second;
  }

  std::vector<char> bytes(header.num_vertices * header.stride);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    Fail(path, "cannot be read");
  }
  PointCloud cloud;
  cloud.points.reserve(header.num_vertices);
  for (uint64_t i = 0; i < header.num_vertices; ++i) {
    const char* v = bytes.data() + i * header.stride;
    cloud.points.push_back(
        {ReadScalar(v, xyz[0]), ReadScalar(v, xyz[1]), ReadScalar(v, xyz[2])});
    if (has_normals) {
      cloud.normals.push_back({ReadScalar(v, normal[0]),
                               ReadScalar(v, normal[1]),
                               ReadScalar(v, normal[2])});
    }
    if (has_colors) {
      cloud.colors.push_back({static_cast<uint8_t>(v[rgb[0].offset]),
                              static_cast<uint8_t>(v[rgb[1].offset]),
                              static_cast<uint8_t>(v[rgb[2].offset])});
    }
  }
  return cloud;
}

void WritePly(const std::filesystem::path& path, const PointCloud& cloud) {
  std::ofstream stream(path, std::ios::binary);
  stream.imbue(std::locale::classic());
  stream << "ply\nformat binary_little_endian 1.0\nelement vertex "
         << cloud.points.size()
         << "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!cloud.normals.empty()) {
    stream << "property float nx\nproperty float ny\nproperty float nz\n";
  }
  if (!cloud.colors.empty()) {
    stream << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  }
  stream << "end_header\n";
  const auto write = [&stream](const auto& value) {
    stream.write(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    write(cloud.points[i]);
    if (!cloud.normals.empty()) write(cloud.normals[i]);
    if (!cloud.colors.empty()) write(cloud.colors[i]);
  }
  stream.close();
  if (!stream)
    throw Error(ErrorCode::kOutOfResources,
                path.string() + ": cannot be written");
}

}  // namespace hpm
