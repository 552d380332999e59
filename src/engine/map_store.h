// Where the maps of a run are between its stages and after the last one: files
// with stamps (the controller), or memory (memory_stores.h). What a stage reads
// and when stands in run_stage.cc; a store only keeps and finds.
#pragma once

#include "src/core/consistency_filter.h"
#include "src/engine/problem.h"
#include "src/engine/run_passes.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/image/inverse_depth_map.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace hpm {

struct SourceDepth {
  std::shared_ptr<const InverseDepthMap> map;  // null: there is none
  // False if the map should be there and is not, or lacked such maps itself
  // when it was made. Images that nobody estimates lack nothing.
  bool is_complete = true;
};

// What a stage made of a problem.
struct StageOutput {
  StageOutput(const ViewSet& its_views, HypothesisMap* its_map)
      : views(its_views), map(its_map) {}

  const ViewSet& views;
  HypothesisMap* map;     // the store may take its contents
  bool is_final = false;  // of the last stage
  // False if some map that the stage read should have been there and was not,
  // see SourceDepth: good enough to go on with, not what the whole run gives.
  bool is_complete = true;
  // Of a filtered or rated map, else empty: bit j is set where source j
  // confirms the pixel.
  std::vector<uint32_t> consistent;
  // Of a filtered map and one of an image with gaps, else empty: whether the
  // pixel stays.
  std::vector<bool> keep;
  // Of a map that was rated, else empty; see confidence.h.
  std::vector<float> confidence;
  FilterParams filter = {};          // as it was asked of this problem
  bool filter_is_geometric = false;  // it looked at the sources' depth, too
  double cost_evaluations_per_pixel = 0;
  PhaseTimes seconds;         // wall, per phase
  PhaseTimes device_seconds;  // of a card, per kind of work
};

// Methods for a problem are called by several threads at once, for each problem
// by one at a time. Stages and problems are numbered as in the RunSpec.
class MapStore {
 public:
  virtual ~MapStore() = default;

  // Whether this run has to compute the stage of the problem. Asked once, when
  // the run starts; what is not needed must be there when a later stage reads
  // it, whoever made it.
  virtual bool IsNeeded(int stage, int problem) const = 0;

  // Between two stages: all that the run makes of those before is written.
  virtual void StartStage(int stage) = 0;

  // The planes that `stage` made of the problem, at that stage's size; distance
  // 0: none. Returns whether they are complete, see StageOutput. Throws
  // Error(kBadInput) if they are not there.
  virtual bool ReadPlanes(int stage,
                          int problem,
                          std::vector<Plane>* planes) = 0;

  // The depth that `stage` found in each source of the problem.
  virtual std::vector<SourceDepth> ReadSourceDepths(int stage, int problem) = 0;

  virtual void Write(int stage, int problem, StageOutput* output) = 0;
};

}  // namespace hpm
