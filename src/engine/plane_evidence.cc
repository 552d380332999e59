#include "src/engine/plane_evidence.h"

#include "src/engine/visit_params.h"

#include <algorithm>
#include <utility>

namespace hpm {
namespace {

constexpr float kShift = 2;  // pixels in the median view
// Pixels of the lattice, so that a region has enough of itself to show.
constexpr int kMinInner = 50;

// 1/z + shift everywhere.
Plane Moved(const Plane& plane, float shift) {
  const Vec3f scaled = (1 / plane.distance) * plane.normal - Vec3f{0, 0, shift};
  const float norm = Norm(scaled);
  return {(1 / norm) * scaled, 1 / norm};
}

bool IsNearestOfItsKind(const std::vector<RegionPlane>& list,
                        size_t k,
                        size_t cell) {
  for (const RegionPlane& other : list) {
    if (other.from_rim == list[k].from_rim &&
        other.nearness[cell] > list[k].nearness[cell])
      return false;
  }
  return true;
}

// The pixels of the lattice, by region, that can tell. A window that reaches
// over the rim matches what lies there, at the depth of that, and would find
// any sky at the depth of the roofs below it; so only pixels count whose region
// fills the window, or all of a region too narrow to have such.
std::vector<std::vector<size_t>> PixelsThatTell(const WeakRegions& regions,
                                                int lattice_step,
                                                int patch_radius) {
  std::vector<std::vector<size_t>> all(regions.num_regions + 1);
  std::vector<std::vector<size_t>> inner(all.size());
  for (int row = 0; row < regions.height; row += lattice_step) {
    for (int col = 0; col < regions.width; col += lattice_step) {
      const int label = regions.At(col, row);
      if (label == 0) continue;
      const size_t at = static_cast<size_t>(row) * regions.width + col;
      all[label].push_back(at);
      if (regions.Fills(col, row, patch_radius)) inner[label].push_back(at);
    }
  }
  for (size_t label = 0; label < all.size(); ++label) {
    if (inner[label].size() < kMinInner) inner[label] = std::move(all[label]);
  }
  return inner;
}

// Pixels that are asked about one candidate.
struct Question {
  size_t label, k;  // the candidate
  std::vector<size_t> pixels;
};

std::vector<Question> QuestionsTo(const RegionPlanes& candidates,
                                  const WeakRegions& regions,
                                  std::vector<std::vector<size_t>> telling) {
  std::vector<Question> questions;
  for (size_t label = 1; label < candidates.of_region.size(); ++label) {
    const std::vector<RegionPlane>& of_region = candidates.of_region[label];
    for (size_t k = 0; k < of_region.size(); ++k) {
      Question question = {label, k, {}};
      for (const size_t at : telling[label]) {
        const size_t cell =
            candidates.CellAt(static_cast<int>(at % regions.width),
                              static_cast<int>(at / regions.width));
        if (IsNearestOfItsKind(of_region, k, cell))
          question.pixels.push_back(at);
      }
      if (!question.pixels.empty()) questions.push_back(std::move(question));
    }
  }
  return questions;
}

}  // namespace

std::vector<std::vector<PlaneEvidence>> FindEvidence(
    const ViewSet& views,
    const WeakRegions& regions,
    const RegionPlanes& candidates,
    int lattice_step,
    int patch_radius,
    const ScorePlanes& score) {
  const auto& of_region = candidates.of_region;
  std::vector<std::vector<PlaneEvidence>> result(of_region.size());
  for (size_t label = 0; label < of_region.size(); ++label)
    result[label].resize(of_region[label].size());
  const float parallax = MedianParallax(views);
  if (!(parallax > 0)) return result;
  const float shift = kShift / parallax;
  const std::vector<Question> questions = QuestionsTo(
      candidates, regions, PixelsThatTell(regions, lattice_step, patch_radius));
  std::vector<PixelPlane> planes;
  for (const Question& question : questions) {
    for (const float moved : {0.0f, shift, -shift}) {
      const Plane plane =
          Moved(of_region[question.label][question.k].plane, moved);
      for (const size_t at : question.pixels) {
        planes.push_back({static_cast<int>(at % regions.width),
                          static_cast<int>(at / regions.width),
                          plane});
      }
    }
  }
  const std::vector<float> costs = score(planes);
  auto cost = costs.begin();
  for (const Question& question : questions) {
    double sums[3] = {};  // at the plane, nearer, farther
    for (double& sum : sums) {
      for (size_t i = 0; i < question.pixels.size(); ++i) sum += *cost++;
    }
    const auto count = static_cast<int>(question.pixels.size());
    result[question.label][question.k] = {
        count, (std::min(sums[1], sums[2]) - sums[0]) / count};
  }
  return result;
}

}  // namespace hpm
