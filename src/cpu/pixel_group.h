// Pixels of one colour in one row that a sweep visits together: the costs that
// one of them asks for seldom fill the vectors, those of all do. They are
// independent of each other, so the result is that of one visit after the
// other.
#pragma once

#include "src/core/sweep.h"
#include "src/cpu/cpu_views.h"

#include <cstdint>
#include <vector>

namespace hpm {

class PixelGroup {
 public:
  // For the pixels of a sweep of kind kInitialize or kUpdate.
  PixelGroup(const CpuViews& views,
             const CpuTarget& target,
             const SweepScope& scope);
  ~PixelGroup();

  // Visits (col, row), (col + 2, row), ... as far as the image and the group
  // go; returns the column of the next one.
  int Visit(int col, int row);

  // Matching costs evaluated so far.
  uint64_t num_evaluations() const { return num_evaluations_; }

 private:
  // A pixel of the group and what is known of it between two batches of costs.
  struct Member;

  void Initialize(int col, int row, int end);
  void Update(int col, int row, int end);
  void SearchCandidates();

  void Add(int col, int row);
  // Asks for the costs of all planes in all views at a pixel; they are there
  // after Answer().
  void Ask(const Member& member,
           const Plane* planes,
           int num_planes,
           const uint8_t* views,
           int num_views,
           float* costs);
  void Answer();

  const CpuViews& views_;
  const CpuTarget& target_;
  const SweepScope& scope_;
  RefPatches patches_;
  std::vector<Member> members_;
  std::vector<MatchRequest> requests_;
  uint64_t num_evaluations_ = 0;
};

}  // namespace hpm
