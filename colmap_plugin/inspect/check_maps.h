// `hpm_mvs check`: what is wrong with the maps of a workspace, by the plan of
// the run that would make them.
#pragma once

#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <string>
#include <vector>

namespace hpm {

enum class FindingKind { kDamaged, kStale, kForeign, kMissing };

struct Finding {
  FindingKind kind;
  std::string what;  // file below the stereo folder, or image and stage
  std::string reason;
  bool removed = false;
};

struct MapCheck {
  std::vector<Finding> findings;
  int num_files = 0;  // read

  int Count(FindingKind kind) const;
};

// Looks at everything and, with `fix`, removes what is damaged, with its stamp;
// without, nothing is changed. Throws Error(kBadInput) for a workspace that no
// run could use or a file that cannot be removed, Error(kLocked) if it is to
// remove and a run is at work, Error(kInterrupted).
MapCheck CheckMaps(const ControllerOptions& options,
                   bool fix,
                   const LogSink& log,
                   const CancelToken& cancel);

// A line per finding and one that counts.
std::string CheckText(const MapCheck& check);

}  // namespace hpm
