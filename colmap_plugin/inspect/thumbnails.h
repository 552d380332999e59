// Small pictures of images and maps.
#pragma once

#include "colmap_plugin/formats/map_file.h"

#include <filesystem>
#include <string>

namespace hpm {

// Longest side of a picture in pixels.
constexpr int kThumbnailSide = 144;

// A map of about the size of a thumbnail: one pixel of each block. Reads only
// the rows that it needs. Throws Error(kBadInput).
Map ReadThinned(const std::filesystem::path& path);

// JPEG files.
std::string DepthThumbnail(const Map& thinned);
std::string NormalThumbnail(const Map& thinned);
std::string ConfidenceThumbnail(const Map& thinned);
// Empty if the file cannot be decoded.
std::string PictureThumbnail(const std::filesystem::path& path);

}  // namespace hpm
