// The small tables of a problem, computed on the host; images and maps are
// moved by whoever owns the memory.
#pragma once

#include "src/engine/pass.h"
#include "src/engine/view.h"
#include "src/gpu/device_problem.h"

#include <vector>

namespace hpm {

struct ProblemTables {
  DeviceProblem problem;  // all pointers null
  VisitParams visit;      // what SetPass() starts from
  MethodParams method;
  std::vector<float> color_weights;
  std::vector<ViewGeometry> views;     // texels null
  std::vector<DepthView> depth_views;  // inverse_depths null
  std::vector<Vec3f> src_centers;
};

ProblemTables MakeProblemTables(const ViewSet& views,
                                const MethodParams& params);

// Makes `problem` that of a pass.
void SetPass(const Pass& pass,
             const SamplingPattern& pattern,
             ProblemTables* tables);

}  // namespace hpm
