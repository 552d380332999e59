// `hpm_mvs status`: how far a workspace is, by the plan of the run that would
// go on with it.
#pragma once

#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <string>
#include <vector>

namespace hpm {

struct StageStatus {
  std::string name;
  // Whose maps are there and good, or are of no use any more, since those of a
  // later stage are.
  int num_finished = 0;
  // What a run would make; among them maps that are there, but made without
  // those of some source (incomplete), damaged, or made with other options or
  // inputs (stale).
  int num_needed = 0;
  int num_incomplete = 0;
  int num_damaged = 0;
  int num_stale = 0;
};

struct RunStatus {
  std::vector<StageStatus> stages;  // in the order of the run
  // References without a picture of their own or of a source: a run fails for
  // them, and makes the others.
  std::vector<std::string> failing;

  int num_needed() const;
  // Whether there are finished maps of all references.
  bool IsComplete() const { return num_needed() == 0 && failing.empty(); }
};

// Changes nothing. verify: reads all maps and compares their checksums, also
// where length and time are those of the stamp. Throws as a run does when it
// plans. log: gets what a run would say about the workspace.
RunStatus FindStatus(const ControllerOptions& options,
                     bool verify,
                     const LogSink& log,
                     const CancelToken& cancel);

// A table for people.
std::string StatusText(const RunStatus& status);
// One line of JSON: "complete", "failing", "stages" with name and counts.
std::string StatusJson(const RunStatus& status);

}  // namespace hpm
