// A warp on the host: 32 contexts of one thread that take turns. Between two
// meetings each lane runs alone, in an order that changes from meeting to
// meeting, so that code which leans on an order fails.
#pragma once

#include "cuda/pixel_tiles.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include <ucontext.h>

namespace hpm {

class HostWarp {
 public:
  // What a lane sees of its warp; see warp_pool.h.
  class Lane {
   public:
    Lane(HostWarp* warp, int lane) : warp_(warp), lane_(lane) {}
    int lane() const { return lane_; }
    uint32_t Ballot(bool vote) const { return warp_->Meet(lane_, vote); }
    void Sync() const { warp_->Meet(lane_, false); }

   private:
    HostWarp* warp_;
    int lane_;
  };

  HostWarp() : stacks_(kWarpSize, std::vector<char>(kStackBytes)) {}

  // Runs body(lane) as 32 lanes. Throws std::logic_error if some lanes end
  // while others wait for them: on a card that would hang.
  void Run(const std::function<void(const Lane&)>& body) {
    body_ = &body;
    for (int i = 0; i < kWarpSize; ++i) {
      done_[i] = false;
      getcontext(&lanes_[i]);
      lanes_[i].uc_stack.ss_sp = stacks_[i].data();
      lanes_[i].uc_stack.ss_size = stacks_[i].size();
      lanes_[i].uc_link = &scheduler_;
      const auto self = reinterpret_cast<uintptr_t>(this);
      makecontext(&lanes_[i],
                  reinterpret_cast<void (*)()>(&HostWarp::Start),
                  3,
                  static_cast<unsigned>(self >> 32),
                  static_cast<unsigned>(self),
                  i);
    }
    for (;;) {
      votes_ = 0;
      int num_waiting = 0;
      order_ = order_ * 5 + 7;
      for (int k = 0; k < kWarpSize; ++k) {
        const int i = (k * 11 + static_cast<int>(order_)) & (kWarpSize - 1);
        if (!done_[i]) swapcontext(&scheduler_, &lanes_[i]);
        num_waiting += !done_[i];
      }
      if (num_waiting == 0) return;
      if (num_waiting < kWarpSize) {
        throw std::logic_error("lanes wait for lanes that have ended");
      }
      result_ = votes_;
    }
  }

 private:
  static constexpr size_t kStackBytes = 256 << 10;

  static void Start(unsigned high, unsigned low, int lane) {
    auto* self =
        reinterpret_cast<HostWarp*>(static_cast<uintptr_t>(high) << 32 | low);
    (*self->body_)(Lane(self, lane));
    self->done_[lane] = true;
  }

  uint32_t Meet(int lane, bool vote) {
    votes_ |= static_cast<uint32_t>(vote) << lane;
    swapcontext(&lanes_[lane], &scheduler_);
    return result_;
  }

  const std::function<void(const Lane&)>* body_ = nullptr;
  std::vector<std::vector<char>> stacks_;
  ucontext_t scheduler_ = {};
  ucontext_t lanes_[kWarpSize] = {};
  bool done_[kWarpSize] = {};
  uint32_t votes_ = 0, result_ = 0;
  uint32_t order_ = 1;
};

}  // namespace hpm
