// Says when the poses of an images file and those of rigs and frames disagree.
#pragma once

#include "colmap_plugin/formats/model_pose.h"
#include "colmap_plugin/formats/sparse_model.h"

#include <string>
#include <vector>

namespace hpm {

// images: with the poses that count, those of rigs and frames; images_file: the
// poses of the images file in the same order. One line, or nothing if they
// agree but for the digits that writing text costs. extension: of the files,
// ".bin" or ".txt".
std::string DescribeStalePoses(const std::vector<SparseImage>& images,
                               const std::vector<RigidPose>& images_file,
                               const std::string& extension);

}  // namespace hpm
