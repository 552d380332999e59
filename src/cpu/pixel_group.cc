#include "src/cpu/pixel_group.h"

#include <algorithm>

namespace hpm {

struct PixelGroup::Member {
  // Leaves out what is written before it is read: there are hundreds of
  // millions of visits.
  Member(const PixelVisit& pixel,
         const CpuPixelErrors& pixel_errors,
         Rng random)
      : visit(pixel), errors(pixel_errors), rng(random) {}

  PixelVisit visit;
  CpuPixelErrors errors;
  Rng rng;
  CandidateSearch search;
  bool searching;
  PixelUpdate update;
  Candidates candidates;
  float costs[kNumRegions * kMaxViews];  // that are asked for
};

PixelGroup::PixelGroup(const CpuViews& views,
                       const CpuTarget& target,
                       const SweepScope& scope)
    : views_(views), target_(target), scope_(scope) {
  members_.reserve(target.num_lanes);
  requests_.reserve(target.num_lanes);
}

PixelGroup::~PixelGroup() = default;

int PixelGroup::Visit(int col, int row) {
  const int end = std::min(col + 2 * target_.num_lanes, scope_.state.width);
  members_.clear();
  if (scope_.sweep.kind == SweepKind::kInitialize) {
    Initialize(col, row, end);
  } else {
    Update(col, row, end);
  }
  return col + 2 * target_.num_lanes;
}

void PixelGroup::Add(int col, int row) {
  patches_.Set(static_cast<int>(members_.size()), views_.PatchAt(col, row));
  members_.emplace_back(
      VisitOf(scope_.params,
              scope_.pattern,
              scope_.state,
              scope_.sweep.iteration,
              col,
              row),
      CpuPixelErrors(
          views_, target_, scope_.params.geometric_term.max_error, col, row),
      Rng(scope_.sweep.key, col, row));
}

void PixelGroup::Ask(const Member& member,
                     const Plane* planes,
                     int num_planes,
                     const uint8_t* views,
                     int num_views,
                     float* costs) {
  const PixelVisit& visit = member.visit;
  requests_.push_back(
      {{visit.col, visit.row, planes, num_planes, views, num_views},
       static_cast<int>(&member - members_.data()),
       costs});
  num_evaluations_ += static_cast<uint64_t>(num_planes) * num_views;
}

void PixelGroup::Answer() {
  if (requests_.empty()) return;
  target_.match_costs(views_.match(),
                      patches_,
                      requests_.data(),
                      static_cast<int>(requests_.size()));
  requests_.clear();
}

void PixelGroup::Initialize(int col, int row, int end) {
  const VisitParams& params = scope_.params;
  const PixelState& state = scope_.state;
  const StartFrom start = scope_.sweep.start;
  for (; col < end; col += 2) {
    if (start == StartFrom::kRandom ||
        StartsAt(start, state.planes[row * state.width + col]))
      Add(col, row);
  }
  for (Member& member : members_) {
    const PixelVisit& visit = member.visit;
    Plane* plane = &state.planes[visit.at];
    *plane = StartPlane(params, state, start, &member.rng, visit.col, row);
    Candidates& asked = member.candidates;
    asked.num_views =
        ListViews(ViewsToAsk(params, state, start, visit.col, row),
                  params.num_views,
                  asked.view);
    Ask(member, plane, 1, asked.view, asked.num_views, member.costs);
  }
  Answer();
  for (Member& member : members_) {
    const Candidates& asked = member.candidates;
    const int at = member.visit.at;
    state.costs[at] = BestViewsCost(
        member.costs, asked.view, asked.num_views, &state.masks[at]);
  }
}

void PixelGroup::Update(int col, int row, int end) {
  for (; col < end; col += 2) {
    if (!PassesOver(scope_.sweep, scope_.state, col, row)) Add(col, row);
  }
  SearchCandidates();
  for (Member& member : members_) {
    PixelUpdate& update = member.update;
    if (!ChooseWeights(member.visit, member.candidates, &member.rng, &update))
      continue;
    Ask(member,
        &update.best.plane,
        1,
        update.weights.view,
        update.weights.num_views,
        member.costs);
  }
  Answer();
  for (Member& member : members_) {
    PixelUpdate& update = member.update;
    Propagate(member.visit,
              member.errors,
              member.candidates,
              member.costs,
              &member.rng,
              &update);
    Ask(member,
        update.planes,
        update.num_planes,
        update.weights.view,
        update.weights.num_views,
        member.costs);
  }
  Answer();
  for (Member& member : members_) {
    const PixelUpdate& update = member.update;
    float means[kNumRefined];
    MeanCosts(
        scope_.params, update.weights, member.costs, update.num_planes, means);
    FinishUpdate(member.visit, member.errors, means, &member.update);
  }
}

// As CollectCandidates().
void PixelGroup::SearchCandidates() {
  for (Member& member : members_) {
    BeginSearch(
        member.visit, member.rng.Uniform(), &member.search, &member.candidates);
    member.searching = true;
  }
  for (bool any = true; any;) {
    for (Member& member : members_) {
      const CandidateBatch& batch = member.search.batch;
      if (!member.searching || batch.size == 0) continue;
      Ask(member,
          batch.plane,
          batch.size,
          member.candidates.view,
          member.candidates.num_views,
          member.costs);
    }
    Answer();
    any = false;
    for (Member& member : members_) {
      if (!member.searching) continue;
      member.searching = ContinueSearch(
          member.visit, member.costs, &member.search, &member.candidates);
      any |= member.searching;
    }
  }
}

}  // namespace hpm
