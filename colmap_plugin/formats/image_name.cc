#include "colmap_plugin/formats/image_name.h"

#include "src/base/error.h"

#include <algorithm>

#include <fmt/format.h>

namespace hpm {
namespace {

bool IsControl(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

const char* FaultOfName(std::string_view name) {
  if (name.empty()) return "is empty";
  if (std::any_of(name.begin(), name.end(), IsControl))
    return "has control characters";
  if (name.front() == '/') return "is an absolute path";
  std::string_view component;
  for (size_t begin = 0; begin <= name.size(); begin += component.size() + 1) {
    component = name.substr(begin, name.substr(begin).find('/'));
    if (component == "..") return "leaves the image folder by '..'";
  }
  if (component.empty() || component == ".") return "names a folder";
  return nullptr;
}

}  // namespace

void CheckImageName(const std::string& name) {
  if (const char* fault = FaultOfName(name)) {
    throw Error(
        ErrorCode::kBadInput,
        fmt::format(
            "the image name {} {}; rename the image in the sparse model",
            QuotedName(name),
            fault));
  }
}

bool IsImageName(std::string_view name) { return FaultOfName(name) == nullptr; }

std::string WithSlashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

std::string QuotedName(std::string_view name) {
  constexpr size_t kMaxLength = 100;
  std::string quoted = "'";
  for (const char c : name.substr(0, kMaxLength)) {
    if (IsControl(c)) {
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + (name.size() > kMaxLength ? "...'" : "'");
}

}  // namespace hpm
