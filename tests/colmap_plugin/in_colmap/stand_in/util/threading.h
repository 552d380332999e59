// What the glue needs of COLMAP 3.8's header of this name.
#pragma once

namespace colmap {

class Thread {
 public:
  virtual ~Thread() = default;
  void Stop() { is_stopped_ = true; }
  int num_asked() const { return num_asked_; }

 protected:
  virtual void Run() = 0;
  bool IsStopped() {
    ++num_asked_;
    return is_stopped_;
  }
  void BlockIfPaused() {}

 private:
  bool is_stopped_ = false;
  int num_asked_ = 0;
};

}  // namespace colmap
