// See parallel_for.h in this folder.
#pragma once

namespace tbb {

class task_arena {
 public:
  explicit task_arena(int num_threads) : num_threads_(num_threads) {}
  int max_concurrency() const { return num_threads_; }
  template <class Function>
  void execute(const Function& function) {
    function();
  }

 private:
  int num_threads_;
};

namespace this_task_arena {
inline int max_concurrency() { return 2; }
template <class Function>
void isolate(const Function& function) {
  function();
}
}  // namespace this_task_arena

}  // namespace tbb
