// Computes one stage of one image: reads the inputs, runs the passes, filters,
// publishes normal map, depth map, graph and stamp in this order.
#pragma once

#include "colmap_plugin/controller/filter_losses.h"
#include "colmap_plugin/controller/input_cache.h"
#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "src/engine/backend.h"
#include "src/engine/estimator.h"

#include <nlohmann/json.hpp>

namespace hpm {

struct StageResult {
  double valid_pixel_share = 0;
  double cost_evaluations_per_pixel = 0;
  FilterLosses losses;        // of a final stage
  PhaseTimes seconds;         // wall, per phase
  PhaseTimes device_seconds;  // of a card, per kind of work
};

nlohmann::json ToJson(const StageResult& result);

class StageRunner {
 public:
  // Keeps references to all arguments.
  StageRunner(const Workspace& workspace,
              const std::vector<StereoProblem>& problems,
              const Schedule& schedule,
              const ControllerOptions& options,
              const StagePlan& plan,
              const RunLock& lock,
              InputCache* inputs,
              Backend* backend,
              const LogSink& log);

  // Throws UnreadableImage if the reference or a source cannot be decoded,
  // Error(kLocked) instead of publishing when the lock is lost.
  StageResult Run(int stage, int problem, const RunControl& control);

 private:
  ViewSet MakeViews(int stage, int problem);
  // images: the reference, then the sources.
  void AddDepths(int stage,
                 const std::vector<ImageRequest>& images,
                 ViewSet* views);
  // Makes map_ the hypotheses the stage starts from: none, those of the stage
  // before, or those of the coarser level upsampled.
  void StartMap(int stage, int problem, const ViewSet& views);
  void Publish(int stage,
               int problem,
               const ViewSet& views,
               const RunControl& control,
               StageResult* result);
  // Writes map_.
  void WriteMaps(const Camera& camera,
                 const DepthRange& range,
                 const std::vector<bool>* keep,
                 const StageFiles& files,
                 Stamp* stamp,
                 StageResult* result);

  const Workspace& workspace_;
  const std::vector<StereoProblem>& problems_;
  const Schedule& schedule_;
  const ControllerOptions& options_;
  const StagePlan& plan_;
  const RunLock& lock_;
  InputCache* inputs_;
  Backend* backend_;
  const LogSink& log_;
  const MethodParams params_;
  // Of the current problem; its memory stays for the next.
  HypothesisMap map_;
  // Of the current problem: sources without depth maps, and whether one that
  // should have them lacks them, or has them from incomplete inputs.
  int num_without_maps_ = 0;
  bool misses_maps_ = false;
  // Image index of each source view of the current problem.
  std::vector<int> src_images_;
};

}  // namespace hpm
