// What a report tells, gathered from the workspace, its maps, stamps and run
// record.
#pragma once

#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace hpm {

struct ReportedSource {
  std::string name;
  int num_shared = 0;  // sparse points that both images see
};

struct DepthSpan {
  float near = 0, far = 0;
};

struct ReportedImage {
  std::string name;
  int width = 0, height = 0;  // of its maps; else of the working image
  bool has_maps = false;
  std::string why_not;  // the maps cannot be read; empty: not computed
  std::vector<ReportedSource> sources;
  // Shares of the pixels, 0..1. Losses: by criterion, of what the filter took.
  std::optional<double> valid_share;
  std::map<std::string, double> losses;
  std::optional<double> seconds;
  // All but the extreme two percent: of the map, and of the sparse points.
  std::optional<DepthSpan> depths, sparse_depths;
  // JPEG files.
  std::string picture, depth, normal;
};

struct ReportData {
  std::string program;  // name and version
  std::string workspace;
  std::filesystem::path stereo_path;
  std::string stage;   // "geometric" or "photometric"
  nlohmann::json run;  // run.json, or null
  std::vector<ReportedImage> images;
};

// Throws as a run would for a workspace that cannot be read; what is wrong with
// single maps is in the data.
ReportData GatherReport(const ControllerOptions& options,
                        const LogSink& log,
                        const CancelToken& cancel);

}  // namespace hpm
