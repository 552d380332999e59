// A PMVS folder as COLMAP reads it: bundle.rd.out, else vis.dat with txt/.
// Images are visualize/%08d.jpg and get the names "%08d.jpg", image index =
// number. Throws Error(kBadInput) naming file and line.
#pragma once

#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/formats/sparse_model.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace hpm {

// Width and height in pixels of an image file; throws if it cannot be read.
using ImageSizeReader =
    std::function<std::pair<int, int>(const std::filesystem::path&)>;

struct PmvsModel {
  // PINHOLE cameras, one per image: (f, f, W/2, H/2) from bundle.rd.out, or
  // taken from the projection matrix with its skew set to 0. A pose that is no
  // rotation (a bundler entry of zeros) is all NaN, see sparse_model.h. vis.dat
  // has no points.
  SparseModel sparse;
  // Only without bundle.rd.out: for each image the other images that vis.dat
  // lists.
  std::optional<std::vector<std::vector<int>>> visible_images;
};

PmvsModel ReadPmvsModel(const std::filesystem::path& folder,
                        const ImageSizeReader& image_size);

// The image indices of the line "timages N i1 ... iN" or "timages -1 begin end"
// (half open); the last such line counts. All are below num_images.
std::vector<int> ReadPmvsOptionFile(const std::filesystem::path& path,
                                    int num_images);

// One entry per image: its visible images where vis.dat was read, else
// "__auto__, 20". (COLMAP takes the visibility by position in the option file;
// here it is that of the image itself, the same thing when all images are
// listed.)
std::vector<PatchMatchCfgEntry> MakePmvsCfgEntries(
    const PmvsModel& model, const std::vector<int>& image_indices);

}  // namespace hpm
