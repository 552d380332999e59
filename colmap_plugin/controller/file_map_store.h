// The maps of a run in the workspace: asks StagePlan which are finished,
// publishes normal map, depth map, graph and stamp in this order.
#pragma once

#include "colmap_plugin/controller/input_cache.h"
#include "colmap_plugin/controller/run_statistics.h"
#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "src/base/log.h"
#include "src/engine/map_store.h"

#include <vector>

namespace hpm {

class FileMapStore : public MapStore {
 public:
  // Keeps references to all arguments. What it writes is counted in
  // *statistics; images that have failed there, references or not, are not
  // tried again.
  FileMapStore(const Workspace& workspace,
               const std::vector<StereoProblem>& problems,
               const ControllerOptions& options,
               const StagePlan& plan,
               const RunLock& lock,
               InputCache* inputs,
               RunStatistics* statistics,
               const LogSink& log);

  bool IsNeeded(int stage, int problem) const override;
  void StartStage(int stage) override;
  bool ReadPlanes(int stage, int problem, std::vector<Plane>* planes) override;
  std::vector<SourceDepth> ReadSourceDepths(int stage, int problem) override;
  // Throws Error(kLocked) instead of publishing when the lock is lost.
  void Write(int stage, int problem, StageOutput* output) override;

 private:
  // Writes all files but the stamp.
  void WriteFiles(int stage,
                  int problem,
                  const StageOutput& output,
                  Stamp* stamp,
                  StageResult* result);
  void WriteMaps(int stage,
                 int problem,
                 const StageOutput& output,
                 Stamp* stamp,
                 StageResult* result);
  // 0 where the depth map has none.
  static PublishedFile WriteConfidence(const StageFiles& files,
                                       const StageOutput& output);
  PublishedFile WriteGraph(int stage,
                           int problem,
                           const StageOutput& output) const;

  const Workspace& workspace_;
  const std::vector<StereoProblem>& problems_;
  const ControllerOptions& options_;
  const StagePlan& plan_;
  const RunLock& lock_;
  InputCache* inputs_;
  RunStatistics* statistics_;
  const LogSink& log_;
};

}  // namespace hpm
