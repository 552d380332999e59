// What a run says at its end about results that are not what they seem: one
// line for each kind of fault.
#pragma once

#include "colmap_plugin/controller/filter_losses.h"
#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/workspace/problem.h"
#include "src/base/log.h"

#include <map>
#include <string>
#include <vector>

namespace hpm {

// What came from such images is stamped as incomplete.
void WarnOfChangedImages(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const ImageContents& contents,
                         const LogSink& log);

// Of images that cannot be computed any more: fusion takes what is there.
void WarnOfOldMaps(const Workspace& workspace,
                   const std::vector<StereoProblem>& problems,
                   const StagePlan& plan,
                   const LogSink& log);

// But for those of which FilterWarnings() tells. valid_shares: by image, of its
// pixels, 0..1, those with a depth.
void WarnOfEmptyMaps(const std::map<std::string, double>& valid_shares,
                     const std::map<std::string, FilterLosses>& losses,
                     const LogSink& log);

}  // namespace hpm
