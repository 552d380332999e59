// The interface between the schedule and whatever computes: CPU or GPU.
#pragma once

#include "src/base/cancel.h"
#include "src/core/consistency_filter.h"
#include "src/engine/pass.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace hpm {

struct RunControl {
  const CancelToken* cancel;
  std::function<void(double)> progress;  // share of the pass that is done, 0..1
};

// Held by the engine beside what a backend takes, per pixel of the reference: a
// HypothesisMap, as much again while levels are merged or priors made, and
// how many visits it needs.
constexpr uint64_t kEngineBytesPerPixel =
    2 * (sizeof(Plane) + sizeof(float) + sizeof(uint32_t)) + sizeof(uint8_t);

class Backend {
 public:
  virtual ~Backend() = default;

  // E.g. "cpu avx3, 2 threads"; goes into the log and the run record.
  virtual std::string Name() const = 0;

  // Working memory of the host, in bytes, for one reference of this size beside
  // the inputs handed to SetViews: the engine's and the backend's own.
  virtual uint64_t MemoryNeeded(int width, int height, int num_srcs) const = 0;

  // Takes the images and cameras of a problem; replaces the problem before.
  virtual void SetViews(const ViewSet& views, const MethodParams& params) = 0;

  // Gives back what the problem holds, as far as that is host memory; SetViews
  // starts the next.
  virtual void ForgetViews() {}

  // Whether Run takes priors of a coarser level (HypothesisMap::prior_level)
  // and upsamples them itself.
  virtual bool UpsamplesPriors() const { return false; }

  // Runs one pass in place and touches the map. A backend that holds the map's
  // generation need not fetch it, here and in ConsistentViews(). Throws
  // Error(kInterrupted) when cancelled.
  virtual void Run(const Pass& pass,
                   const SamplingPattern& pattern,
                   HypothesisMap* map,
                   const RunControl& control) = 0;

  // The matching cost of every plane at its pixel, from all views.
  virtual std::vector<float> Score(const std::vector<PixelPlane>& planes,
                                   const RunControl& control) = 0;

  // Bit j of the result: source view j is consistent with the pixel's plane.
  virtual std::vector<uint32_t> ConsistentViews(const HypothesisMap& map,
                                                const FilterParams& filter,
                                                bool geometric,
                                                const RunControl& control) = 0;

  // Matching costs computed since the last SetViews.
  virtual uint64_t num_cost_evaluations() const = 0;

  // Seconds that a device of its own has worked since the last SetViews, by
  // kind of work; none for the CPU.
  virtual std::map<std::string, double> DeviceSeconds() const { return {}; }
};

}  // namespace hpm
