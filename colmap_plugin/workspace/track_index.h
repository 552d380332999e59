// Which sparse points the images see: the tracks the other way round.
#pragma once

#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hpm {

class TrackIndex {
 public:
  // Two passes over the points. Keeps a reference to them. Throws
  // Error(kInterrupted).
  explicit TrackIndex(const Workspace& workspace,
                      const CancelToken& cancel = {});

  enum class Reads { kPoints, kTracks };

  // Calls visit(point, count) in ascending order for each point whose track
  // holds the image, count times, until it returns false. reads: what `visit`
  // looks at. Memory is slow where it is read here and there, so it is asked
  // for some points ahead.
  template <class Visit>
  void ForEachPoint(int image, Reads reads, const Visit& visit) const {
    const uint8_t* at = steps_.data() + begin_[image];
    const uint8_t* const end = steps_.data() + begin_[image + 1];
    size_t point = 0;
    Batch now, next;
    for (bool is_last = false; !is_last; now = next) {
      is_last = at == end;
      next.size = 0;
      while (at != end && next.size < kBatch) {
        point += TakeStep(&at);
        size_t count = 1;
        for (; at != end && *at == 0; ++at) ++count;
        __builtin_prefetch(&points_[point].xyz);
        next.points[next.size++] = {point, count};
      }
      for (size_t i = 0; i < next.size && reads == Reads::kTracks; ++i)
        Prefetch(points_[next.points[i].first].track);
      for (size_t i = 0; i < now.size; ++i) {
        if (!visit(now.points[i].first, now.points[i].second)) return;
      }
    }
  }

 private:
  // Seven bits a byte, low ones first; the eighth tells that more follow.
  static size_t TakeStep(const uint8_t** at) {
    size_t step = 0;
    for (int shift = 0;; shift += 7) {
      const uint8_t byte = *(*at)++;
      step |= static_cast<size_t>(byte & 0x7f) << shift;
      if ((byte & 0x80) == 0) return step;
    }
  }

  // A point and its track lie in some four lines of memory, and a core waits
  // for two dozen at a time: 4 to 8 points are best, 16 take a fifth longer.
  static constexpr size_t kBatch = 6;
  struct Batch {
    std::array<std::pair<size_t, size_t>, kBatch> points;  // with counts
    size_t size = 0;
  };

  static void Prefetch(const SparseTrack& track) {
    constexpr ptrdiff_t kElementsPerCacheLine = 16;
    for (const int* element = track.begin(); element < track.end();
         element += kElementsPerCacheLine)
      __builtin_prefetch(element);
    __builtin_prefetch(track.end() - 1);
  }

  const SparsePoints& points_;
  // Of each image, steps from point to point: where an image sees many points,
  // one byte each, a quarter of their numbers.
  std::vector<size_t> begin_;
  std::vector<uint8_t> steps_;
};

}  // namespace hpm
