// A backend that computes nothing: every pixel gets a plane that faces the
// camera at depth 4, every source confirms it.
#pragma once

#include "src/engine/backend.h"

#include <mutex>
#include <string>
#include <vector>

namespace hpm {

constexpr float kStillDepth = 4;

// What the still backends of a test were asked, in order.
struct StillLog {
  std::mutex mutex;
  std::vector<ViewSet> views;         // per stage of a problem
  std::vector<std::string> calls;     // "set", "run", "filter", "forget"
  std::vector<FilterParams> filters;  // as they came
};

class StillBackend : public Backend {
 public:
  explicit StillBackend(StillLog* log) : log_(log) {}

  std::string Name() const override { return "still"; }
  uint64_t MemoryNeeded(int, int, int) const override { return 0; }
  void SetViews(const ViewSet& views, const MethodParams&) override {
    Note("set");
    const std::lock_guard<std::mutex> lock(log_->mutex);
    log_->views.push_back(views);
  }
  void ForgetViews() override { Note("forget"); }
  void Run(const Pass&,
           const SamplingPattern&,
           HypothesisMap* map,
           const RunControl& control) override {
    Note("run");
    control.cancel->ThrowIfCancelled();
    if (control.progress) control.progress(0.5);
    map->planes.assign(map->planes.size(), {{0, 0, -1}, kStillDepth});
    map->Touch();
  }
  std::vector<float> Score(const std::vector<PixelPlane>& planes,
                           const RunControl&) override {
    return std::vector<float>(planes.size(), 0.0f);
  }
  std::vector<uint32_t> ConsistentViews(const HypothesisMap& map,
                                        const FilterParams& filter,
                                        bool,
                                        const RunControl&) override {
    Note("filter");
    const std::lock_guard<std::mutex> lock(log_->mutex);
    log_->filters.push_back(filter);
    return std::vector<uint32_t>(map.planes.size(), ~0u);
  }
  uint64_t num_cost_evaluations() const override { return 0; }

 private:
  void Note(const char* call) {
    const std::lock_guard<std::mutex> lock(log_->mutex);
    log_->calls.emplace_back(call);
  }

  StillLog* log_;
};

}  // namespace hpm
