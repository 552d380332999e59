// Runs whole methods on rendered views, without files, and measures the result
// against the truth.
#pragma once

#include "src/engine/estimator.h"
#include "tests/scenes/render.h"

#include <vector>

namespace hpm {

View AsView(const RenderedView& rendered);

// Every view in turn is the reference of all others. `stages` run one after the
// other, each over all views; the last one only over the first `num_final`.
// Depths may lie within 30 % around the true ones of each view.
std::vector<HypothesisMap> EstimateScene(Backend* backend,
                                         const std::vector<RenderedView>& views,
                                         const ScheduleOptions& options,
                                         int num_final);

// The same for given problems; stage by stage, the sources' depth is taken from
// the maps of the views whose number is in sources[i].
struct Problem {
  ViewSet views;
  std::vector<int> sources;  // problem of each source view
};
std::vector<HypothesisMap> EstimateProblems(Backend* backend,
                                            std::vector<Problem> problems,
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
