#include "src/gpu/problem_tables.h"

#include "src/engine/source_geometry.h"
#include "src/engine/visit_params.h"

namespace hpm {

ProblemTables MakeProblemTables(const ViewSet& views,
                                const MethodParams& params) {
  ProblemTables tables = {};
  tables.visit = MakeVisitParams(views, params);
  tables.method = params;
  tables.problem.params = tables.visit;
  tables.problem.shape = ShapeOf(params);
  tables.problem.shape.ref_has_gaps = views.ref.image->has_gaps;
  for (const bool mixed : {false, true}) {
    for (int i = 0; i < 256; ++i) {
      tables.color_weights.push_back(
          ColorWeight(tables.problem.shape, mixed, static_cast<float>(i)));
    }
  }
  for (const View& src : views.srcs) {
    tables.depth_views.push_back(DepthViewOf(views.ref.camera, src));
    tables.src_centers.push_back(CenterOf(views.ref.camera, src));
    const ViewWarp& warp = tables.depth_views.back().to_src;
    ViewGeometry geometry = {};
    for (int i = 0; i < 9; ++i) geometry.M[i] = warp.M.m[i];
    geometry.v[0] = warp.v.x;
    geometry.v[1] = warp.v.y;
    geometry.v[2] = warp.v.z;
    geometry.width = src.image->width;
    geometry.height = src.image->height;
    geometry.max_u = static_cast<float>(src.image->width - 1);
    geometry.max_v = static_cast<float>(src.image->height - 1);
    geometry.has_gaps = src.image->has_gaps;
    tables.views.push_back(geometry);
  }
  return tables;
}

void SetPass(const Pass& pass,
             const SamplingPattern& pattern,
             ProblemTables* tables) {
  tables->problem.params = ForPass(tables->visit, tables->method, pass);
  tables->problem.pattern = pattern;
}

}  // namespace hpm
