#include "colmap_plugin/workspace/track_index.h"

#include <algorithm>

namespace hpm {
namespace {

constexpr size_t kPointsBetweenLooks = 4096;

// Calls visit(image, step) for each track element, point by point; step: how
// many points lie between this one and the last one of the image.
template <class Visit>
void ForEachStep(const Workspace& workspace,
                 const CancelToken& cancel,
                 const Visit& visit) {
  const SparsePoints& points = workspace.model().points;
  std::vector<size_t> last(workspace.num_images(), 0);
  for (size_t i = 0; i < points.size(); ++i) {
    if (i % kPointsBetweenLooks == 0) cancel.ThrowIfCancelled();
    for (const int image : points[i].track) {
      visit(image, i - last[image]);
      last[image] = i;
    }
  }
}

}  // namespace

TrackIndex::TrackIndex(const Workspace& workspace, const CancelToken& cancel)
    : points_(workspace.model().points), begin_(workspace.num_images() + 1, 0) {
  ForEachStep(workspace, cancel, [&](int image, size_t step) {
    size_t num_bytes = 1;
    while (step >>= 7) ++num_bytes;
    begin_[image + 1] += num_bytes;
  });
  for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  steps_.resize(begin_.back());
  std::vector<size_t> end(begin_.begin(), begin_.end() - 1);
  ForEachStep(workspace, cancel, [&](int image, size_t step) {
    for (; step >= 0x80; step >>= 7)
      steps_[end[image]++] = static_cast<uint8_t>(step | 0x80);
    steps_[end[image]++] = static_cast<uint8_t>(step);
  });
}

}  // namespace hpm
