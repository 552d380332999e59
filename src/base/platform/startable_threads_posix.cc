#include "src/base/threads.h"

#include <condition_variable>
#include <mutex>
#include <vector>

#include <pthread.h>
#include <sys/mman.h>

namespace hpm {
namespace {

class Gate {
 public:
  void Wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    opened_.wait(lock, [this] { return open_; });
  }
  void Open() {
    const std::lock_guard<std::mutex> lock(mutex_);
    open_ = true;
    opened_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool open_ = false;
};

void* WaitAtGate(void* gate) {
  static_cast<Gate*>(gate)->Wait();
  return nullptr;
}

// Address space that is held, not used.
class Spare {
 public:
  explicit Spare(size_t num_bytes)
      : num_bytes_(num_bytes),
        memory_(mmap(nullptr,
                     num_bytes,
                     PROT_NONE,
                     MAP_PRIVATE | MAP_ANONYMOUS,
                     -1,
                     0)) {}
  ~Spare() {
    if (ok()) munmap(memory_, num_bytes_);
  }
  Spare(const Spare&) = delete;
  Spare& operator=(const Spare&) = delete;
  bool ok() const { return memory_ != MAP_FAILED; }

 private:
  size_t num_bytes_;
  void* memory_;
};

}  // namespace

int CountStartableThreads(int most, size_t stack_bytes, size_t spare_bytes) {
  const Spare spare(spare_bytes);
  pthread_attr_t attributes;
  if (!spare.ok() || pthread_attr_init(&attributes) != 0) return 0;
  pthread_attr_setstacksize(&attributes, stack_bytes);
  Gate gate;
  std::vector<pthread_t> threads;
  threads.reserve(most);
  pthread_t thread;
  while (static_cast<int>(threads.size()) < most &&
         pthread_create(&thread, &attributes, WaitAtGate, &gate) == 0) {
    threads.push_back(thread);
  }
  gate.Open();
  for (const pthread_t started : threads) pthread_join(started, nullptr);
  pthread_attr_destroy(&attributes);
  return static_cast<int>(threads.size());
}

}  // namespace hpm
