// Runs patch match stereo over a workspace, stage by stage (schedule.h).
// Resumes, locks, publishes maps atomically, stops cleanly when cancelled.
#pragma once

#include "colmap_plugin/controller/filter_criterion.h"
#include "colmap_plugin/controller/input_counts.h"
#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace hpm {

// Sent at the start, after every finished part of an image, and at the end of a
// stage.
struct ProgressEvent {
  std::string stage;  // "photometric", "geometric 1/2", ...
  std::string image;  // reference image worked on; empty at the end of a stage
  int image_number = 0;  // 1-based, within the stage
  int num_images = 0;    // of the stage
  double fraction = 0;   // of the whole run, 0..1, by estimated work (kept
                         // images cost nothing)
  std::string title;     // of the stage, for people; see stages.h
};
using ProgressSink = std::function<void(const ProgressEvent&)>;

struct RunSummary {
  int num_problems = 0;
  int num_computed =
      0;  // images of which at least one stage was computed in this run
  int num_kept = 0;  // images whose maps were all complete and current
  std::vector<std::string>
      failed;  // names of images that could not be computed
  std::vector<std::string> warnings;  // of the log
  double seconds = 0;
  double planning_seconds = 0;  // of these, before the first image
  // Of the final maps written in this run, 0..1; nothing where there were none.
  std::optional<double> valid_pixel_share;
  FilterLosses filter_losses;  // the same, of what has no depth
  // Images of the workspace with final maps: what fusion will find.
  int num_fusable = 0;
  // None of the references shares tracks, so fusion joins no images.
  bool fusion_finds_nothing = false;
  double cost_evaluations_per_pixel = 0;
  uint64_t peak_memory_bytes = 0;
  InputCounts inputs_read;
  std::string backend;  // as Backend::Name() has it
};

struct RunEvents;

class PatchMatchController {
 public:
  // Throws Error(kUsage) for option values out of range.
  PatchMatchController(const ControllerOptions& options,
                       LogSink log,
                       ProgressSink progress,
                       const CancelToken& cancel);

  // Throws Error(kBadInput, kLocked, kOutOfResources, kInterrupted ...);
  // kLocked also when another run has taken the workspace over meanwhile.
  // Images that fail one by one do not stop the others; they are listed in the
  // summary.
  RunSummary Run();

 private:
  struct RunState;
  // False: an image proved unreadable, and the run is planned anew without it.
  bool ComputeStages(const RunState& run) const;
  // What the log and the progress sink are told of a run. Keeps references to
  // all of it.
  RunEvents Events(const RunState& run) const;
  RunSummary Summarize(const RunState& run, double seconds) const;

  ControllerOptions options_;
  std::mutex mutex_;  // of warnings_
  std::vector<std::string> warnings_;
  LogSink log_;
  ProgressSink progress_;
  const CancelToken& cancel_;
};

}  // namespace hpm
