// What a report tells, gathered from the workspace, its maps, stamps and run
// record.
#pragma once

#include "colmap_plugin/controller/cost_histogram.h"
#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace hpm {

struct ReportedSource {
  std::string name;
  uint64_t num_shared = 0;  // sparse points that both images see
};

struct DepthSpan {
  float near = 0, far = 0;
};

struct ReportedImage {
  std::string name;
  int width = 0, height = 0;  // of its maps; else of the working image
  bool has_maps = false;
  // The maps cannot be read, or are of a run when the image could be computed;
  // empty, and no maps: not computed.
  std::string why_not;
  std::vector<ReportedSource> sources;
  // Shares of the pixels, 0..1. Losses: by criterion, of what the filter took.
  std::optional<double> valid_share;
  std::map<std::string, double> losses;
  // Of the pixels with a depth; not known of maps that an older version made.
  std::optional<CostHistogram> costs;
  std::optional<double> seconds;
  // All but the extreme two percent: of the map, and of the sparse points.
  std::optional<DepthSpan> depths, sparse_depths;
  // JPEG files; empty where there is none, or too many images to show all.
  std::string picture, depth, normal, confidence;

  // Whether the depths reach far beyond what the sparse points let expect.
  bool HasOddRange() const {
    return depths && sparse_depths &&
           (depths->far > 3 * sparse_depths->far ||
            depths->near < sparse_depths->near / 3);
  }
};

// Images whose pictures a page shows: a browser has to hold them all.
constexpr size_t kMaxPictured = 300;

struct ReportData {
  std::string program;  // name and version
  std::string workspace;
  std::string stage;                  // "geometric" or "photometric"
  nlohmann::json run;                 // run.json, or null
  std::vector<ReportedImage> images;  // pictures: of the kMaxPictured worst
};

// Of an object that others may have written; null if there is no such member,
// or no object.
const nlohmann::json& Member(const nlohmann::json& json,
                             const std::string& key);

// Throws as a run would for a workspace that cannot be read; what is wrong with
// single maps is in the data.
ReportData GatherReport(const ControllerOptions& options,
                        const LogSink& log,
                        const CancelToken& cancel);

}  // namespace hpm
