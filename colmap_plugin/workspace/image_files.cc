#include "colmap_plugin/workspace/image_files.h"

#include "colmap_plugin/formats/image_name.h"
#include "src/base/retries.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

std::string Lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

// The first entry, by name, of the file's folder for which `fits` holds; empty
// if there is none.
template <class Fits>
std::string FindBeside(const fs::path& path, Fits fits) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(path.parent_path(), error), end;
       !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (fits(fs::path(name))) names.push_back(name);
  }
  return names.empty() ? "" : *std::min_element(names.begin(), names.end());
}

}  // namespace

ImageFile FindImageFile(const fs::path& folder, const std::string& name) {
  ImageFile file;
  file.path = folder / name;
  file.exists = IsRegularFile(file.path);
  const std::string slashed = WithSlashes(name);
  if (!file.exists && slashed != name && IsImageName(slashed) &&
      IsRegularFile(folder / slashed)) {
    file.path = folder / slashed;
    file.exists = true;
  }
  if (file.exists) file.size = ReadImageSize(file.path);
  return file;
}

std::string WhyMissing(const fs::path& folder, const std::string& name) {
  const fs::path path = folder / WithSlashes(name);
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    return fmt::format(
        "the folder {} is missing; give it back or run image_undistorter",
        folder.string());
  }
  if (fs::is_symlink(path, ignored)) {
    return fmt::format(
        "it is a link to {}, which does not exist; copy the "
        "images or mend the links",
        fs::read_symlink(path, ignored).string());
  }
  const std::string lower = Lower(path.filename().string());
  const std::string other_case = FindBeside(path, [&](const fs::path& found) {
    return Lower(found.string()) == lower;
  });
  if (!other_case.empty()) {
    return fmt::format(
        "{} is there, in another case; rename the files as the "
        "sparse model names them",
        QuotedName(other_case));
  }
  const std::string stem = Lower(path.stem().string());
  const std::string other_type = FindBeside(path, [&](const fs::path& found) {
    return Lower(found.stem().string()) == stem;
  });
  if (!other_type.empty()) {
    return fmt::format(
        "{} is there, with another extension; the names of the sparse model "
        "and of the files must be the same",
        QuotedName(other_type));
  }
  if (IsRegularFile(folder / path.filename())) {
    return fmt::format(
        "{} is there; names in the sparse model must be "
        "relative to {}",
        QuotedName(path.filename().string()),
        folder.string());
  }
  return "undistort the images again or remove them from the sparse model";
}

bool SameProportions(const ImageSize& camera, const ImageSize& image) {
  // Some scale takes both sides to within a pixel of the image's.
  const auto least = [](int side, int full) { return (side - 1.0) / full; };
  const auto most = [](int side, int full) { return (side + 1.0) / full; };
  return least(image.width, camera.width) <=
             most(image.height, camera.height) &&
         least(image.height, camera.height) <= most(image.width, camera.width);
}

bool IsFarLarger(const ImageSize& camera, const ImageSize& image) {
  // Models of thumbnails of the images are smaller by some few times.
  constexpr double kMostTimes = 16;
  return image.width > kMostTimes * camera.width ||
         image.height > kMostTimes * camera.height;
}

std::string ImageFault::Line(int num_images, const std::string& what) const {
  return fmt::format(
      "{} of {} images {}, the first: {}", num_, num_images, what, first_);
}

}  // namespace hpm
