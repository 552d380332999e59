// What the filter of finished maps took, by criterion, so that a user can be
// told which option to turn.
#pragma once

#include "colmap_plugin/controller/filter_criterion.h"
#include "colmap_plugin/options/options.h"
#include "src/core/consistency_filter.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace hpm {

nlohmann::json ToJson(const FilterLosses& losses);

// A pixel that no source confirms is lost to the criterion that took the last
// one. Looks at one pixel of sixteen: `consistent` is what
// Backend::ConsistentViews() found with the same filter, `keep` what has enough
// of it (NeededViews).
FilterLosses CountFilterLosses(const ViewSet& views,
                               const HypothesisMap& map,
                               const std::vector<uint32_t>& consistent,
                               const std::vector<bool>& keep,
                               const FilterParams& filter,
                               bool geometric);

// One line per criterion that took most of the pixels of some image, with the
// number of such images, an example and the option to turn. Of all images that
// were filtered in this run.
std::vector<std::string> FilterWarnings(
    const std::map<std::string, FilterLosses>& losses_of_images,
    const ControllerOptions& options);

}  // namespace hpm
