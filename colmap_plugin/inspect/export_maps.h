// `hpm_mvs export`: finished maps as files that other programs read.
#pragma once

#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hpm {

struct ExportOptions {
  std::string format = "exr";            // exr, pfm, png16, npy or ply
  std::string input_type = "geometric";  // or photometric
  std::string image_name;                // empty: all images with maps
  // Empty: stereo/export, of photometric maps stereo/export_photometric.
  std::filesystem::path output_path;
  // png16: model units per step; 0: each image's largest depth becomes 65535.
  double depth_step = 0;
};

struct ExportResult {
  std::filesystem::path folder;
  int num_images = 0;
  std::vector<std::string> failed;  // one line each, with reason and remedy
};

// Writes <output_path>/<image name>.depth.<ext>, .normal.<ext> and, where there
// is one, .confidence.<ext>, or
// <image name>.ply, and for all but ply <image name>.json, which says what the
// numbers mean and which camera they belong to, also of what an earlier export
// left there. Damaged maps are not exported. Throws Error(kBadInput) if no
// image has maps or the one that is asked for has none.
ExportResult ExportMaps(const WorkspaceOptions& workspace_options,
                        const ExportOptions& options,
                        const LogSink& log,
                        const CancelToken& cancel);

}  // namespace hpm
