// Runs whole methods on rendered views, without files, and measures the result
// against the truth.
#pragma once

#include "src/engine/run_spec.h"
#include "src/engine/worker_pool.h"
#include "src/image/hypothesis_map.h"
#include "tests/scenes/render.h"

#include <vector>

namespace hpm {

// Every view in turn is the reference of all others. Depths may lie within 30 %
// around the true ones of each view.
RunSpec SceneSpec(const std::vector<RenderedView>& views,
                  const ScheduleOptions& options);

// The stages of the method run one after the other, each over all views; the
// last one only over the first `num_final`, whose maps are returned.
std::vector<HypothesisMap> EstimateScene(WorkerPool* workers,
                                         const std::vector<RenderedView>& views,
                                         const RunSpec& spec,
                                         int num_final);
std::vector<HypothesisMap> EstimateScene(WorkerPool* workers,
                                         const std::vector<RenderedView>& views,
                                         const ScheduleOptions& options,
                                         int num_final);

// Medians over all pixels with a true depth.
struct MapErrors {
  double depth;   // relative
  double normal;  // degrees
};
MapErrors MeasureErrors(const HypothesisMap& map, const RenderedView& truth);

// Every pixel has a finite plane with unit normal toward the camera, a depth in
// front of it and a finite cost. Reports the first pixel that has not.
void ExpectSound(const HypothesisMap& map, const Camera& camera);

}  // namespace hpm
