// Adds the wall time of its life to one phase.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <utility>

namespace hpm {

class PhaseTimer {
 public:
  PhaseTimer(std::map<std::string, double>* times, std::string phase)
      : times_(times), phase_(std::move(phase)), start_(Clock::now()) {}
  ~PhaseTimer() {
    (*times_)[phase_] +=
        std::chrono::duration<double>(Clock::now() - start_).count();
  }
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  std::map<std::string, double>* times_;
  std::string phase_;
  Clock::time_point start_;
};

}  // namespace hpm
