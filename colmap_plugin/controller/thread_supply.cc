#include "colmap_plugin/controller/thread_supply.h"

#include "src/base/threads.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace hpm {
namespace {

int CountThreads(int wanted, const LogSink& log) {
  constexpr int kOfLock = 1;  // its heartbeat
  // Without some address space left libraries end the program, too.
  constexpr size_t kSpareBytes = 32 << 20;
  const int most = kOfLock + wanted - 1;
  const int granted = CountStartableThreads(
      most,
      tbb::global_control::active_value(tbb::global_control::thread_stack_size),
      kSpareBytes);
  if (granted < kOfLock) throw NoThreadError();
  const int num_threads = 1 + granted - kOfLock;
  if (num_threads < wanted) {
    log(LogLevel::kWarning,
        fmt::format("the system grants no more than {} threads, so {} compute "
                    "in place of {}; raise the limit on processes (ulimit -u, "
                    "the container's pids limit) or address space (ulimit -v), "
                    "or set --PatchMatchStereo.num_threads {}",
                    granted + 1,
                    num_threads,
                    wanted,
                    num_threads));
  }
  return num_threads;
}

// oneTBB starts threads when there is work for them: each waits here for the
// others.
void StartThreads(int num_threads) {
  // On a busy machine some may come late; then oneTBB starts them later.
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
  std::atomic<int> arrived{0};
  tbb::task_arena(num_threads).execute([&] {
    tbb::parallel_for(
        0,
        num_threads,
        [&](int) {
          ++arrived;
          while (arrived < num_threads &&
                 std::chrono::steady_clock::now() < end)
            std::this_thread::yield();
        },
        tbb::simple_partitioner());
  });
}

}  // namespace

ThreadSupply::ThreadSupply(int wanted, const LogSink& log)
    : num_threads_(CountThreads(
          wanted > 0 ? wanted : tbb::this_task_arena::max_concurrency(), log)),
      limit_(tbb::global_control::max_allowed_parallelism,
             static_cast<size_t>(num_threads_)) {
  if (num_threads_ > 1) StartThreads(num_threads_);
}

}  // namespace hpm
