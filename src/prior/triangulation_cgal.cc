#include "src/prior/triangulation.h"

#include <utility>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace hpm {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, Structure>;

}  // namespace

std::vector<std::array<int, 3>> Triangulate(
    const std::vector<CrediblePoint>& points, int /*width*/, int /*height*/) {
  std::vector<std::pair<Kernel::Point_2, int>> vertices;
  vertices.reserve(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    vertices.emplace_back(Kernel::Point_2(points[i].col, points[i].row),
                          static_cast<int>(i));
  }
  const Delaunay delaunay(vertices.begin(), vertices.end());
  std::vector<std::array<int, 3>> triangles;
  for (const auto& face : delaunay.finite_face_handles()) {
    triangles.push_back({face->vertex(0)->info(),
                         face->vertex(1)->info(),
                         face->vertex(2)->info()});
  }
  return triangles;
}

}  // namespace hpm
