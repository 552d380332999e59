#include "cuda/cuda_backend.h"

#include "cuda/device_images.h"
#include "cuda/device_memory.h"
#include "cuda/events.h"
#include "cuda/launch.h"
#include "src/base/error.h"
#include "src/engine/phase_timer.h"
#include "src/engine/sweeps.h"
#include "src/engine/work_estimate.h"
#include "src/gpu/band_planner.h"
#include "src/gpu/problem_tables.h"

#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <utility>

namespace hpm {
namespace {

const char* PhaseOf(SweepKind kind) {
  switch (kind) {
    case SweepKind::kInitialize:
      return "initialise";
    case SweepKind::kUpdate:
      return "update";
    case SweepKind::kFollow:
      return "follow";
    case SweepKind::kMedian:
      return "median";
    case SweepKind::kConsistency:
      break;
  }
  return "filter";
}

// What of a map is read before it is written.
enum class Read { kNothing, kPlanes, kAll };

Read ReadBy(StartFrom start) {
  if (start == StartFrom::kRandom) return Read::kNothing;
  return start == StartFrom::kCurrent ? Read::kPlanes : Read::kAll;
}

// Stream, events and the launches that are on their way.
class LaunchQueue {
 public:
  LaunchQueue() = default;
  ~LaunchQueue() {
    // Nothing may still write into memory that is about to be freed.
    cudaStreamSynchronize(stream());
  }
  LaunchQueue(const LaunchQueue&) = delete;
  LaunchQueue& operator=(const LaunchQueue&) = delete;

  cudaStream_t stream() const { return stream_.get(); }

  // Times start(); keeps two launches on the card and hands the oldest to
  // finished(kind, rows, seconds) before it adds a third.
  template <class Start, class Finished>
  void Add(SweepKind kind,
           int num_rows,
           const Start& start,
           const Finished& finished) {
    if (pending_.size() == marks_.size()) FinishOldest(finished);
    const size_t slot = next_slot_++ % marks_.size();
    const Marks& marks = marks_[slot];
    CheckCuda(cudaEventRecord(marks.begin.get(), stream()), "timing a launch");
    start();
    CheckCuda(cudaEventRecord(marks.end.get(), stream()), "timing a launch");
    pending_.push_back({kind, num_rows, slot});
  }

  template <class Finished>
  void FinishAll(const Finished& finished) {
    while (!pending_.empty()) FinishOldest(finished);
  }

  // After an error: forget the launches.
  void Abandon() { pending_.clear(); }

 private:
  // Of a launch, in the stream.
  struct Marks {
    CudaEvent begin{cudaEventBlockingSync};
    CudaEvent end{cudaEventBlockingSync};
  };
  struct Pending {
    SweepKind kind;
    int num_rows;
    size_t slot;
  };

  template <class Finished>
  void FinishOldest(const Finished& finished) {
    const Pending oldest = pending_.front();
    pending_.pop_front();
    const Marks& marks = marks_[oldest.slot];
    CheckCuda(cudaEventSynchronize(marks.end.get()), "running a kernel");
    float milliseconds = 0;
    CheckCuda(
        cudaEventElapsedTime(&milliseconds, marks.begin.get(), marks.end.get()),
        "timing a launch");
    finished(oldest.kind, oldest.num_rows, 1e-3 * milliseconds);
  }

  CudaStream stream_;
  std::array<Marks, 2> marks_;
  std::deque<Pending> pending_;
  size_t next_slot_ = 0;
};

class CudaBackendImpl : public CudaBackend {
 public:
  explicit CudaBackendImpl(const CudaOptions& options)
      : options_(options), planner_(options.launch_seconds) {
    UseDevice();
    cudaDeviceProp properties;
    CheckCuda(cudaGetDeviceProperties(&properties, options.device),
              "asking for the device");
    name_ = properties.name;
    queue_.emplace();
    uploader_.emplace(queue_->stream());
    images_.emplace(options.format);
    counter_.Reserve(1);
  }

  ~CudaBackendImpl() override {
    cudaSetDevice(options_.device);
    queue_.reset();
    uploader_.reset();
  }

  std::string Name() const override {
    return "cuda " + std::to_string(options_.device) + ": " + name_;
  }

  uint64_t MemoryNeeded(int width, int height, int) const override {
    return kEngineBytesPerPixel * width * height + Uploader::kBytes;
  }

  bool UpsamplesPriors() const override { return true; }

  void SetViews(const ViewSet& views, const MethodParams& params) override {
    UseDevice();
    seconds_.clear();
    PhaseTimer timer(&seconds_, "upload");
    resident_ = 0;
    num_evaluations_ = 0;
    random_key_ = views.random_key;
    planner_ = BandPlanner(options_.launch_seconds);
    tables_ = MakeProblemTables(views, params);
    images_->Upload(views, uploader());
    for (size_t j = 0; j < views.srcs.size(); ++j) {
      tables_.views[j].texels = images_->texels(static_cast<int>(j));
      tables_.depth_views[j].inverse_depths =
          images_->inverse_depths(static_cast<int>(j));
    }
    color_weights_.Upload(tables_.color_weights, uploader());
    views_.Upload(tables_.views, uploader());
    depth_views_.Upload(tables_.depth_views, uploader());
    src_centers_.Upload(tables_.src_centers, uploader());
    DeviceProblem& problem = tables_.problem;
    problem.ref_grey = images_->ref_grey();
    problem.color_weights = color_weights_.data();
    problem.views = views_.data();
    problem.depth_views = depth_views_.data();
    problem.src_centers = src_centers_.data();
    problem.texture = images_->texture();
  }

  void Run(const Pass& pass,
           const SamplingPattern& pattern,
           HypothesisMap* map,
           const RunControl& control) override {
    UseDevice();
    SetPass(pass, pattern, &tables_);
    const PixelState state = Upload(*map, ReadBy(pass.start));
    int step = 0;
    for (const Sweep& sweep : SweepsOf(pass, random_key_)) {
      RunSweep(sweep, state, nullptr, control);
      if (CountsAsStep(sweep.kind) && control.progress) {
        control.progress(StepsWork(pass, ++step) / PassWork(pass));
      }
    }
    Finish();
    PhaseTimer timer(&seconds_, "download");
    const size_t size = map->planes.size();
    planes_.Download(map->planes.data(), size, stream());
    costs_.Download(map->costs.data(), size, stream());
    masks_.Download(map->masks.data(), size, stream());
    Wait("copying maps from the card");
    map->Touch();
    resident_ = map->generation;
  }

  std::vector<uint32_t> ConsistentViews(const HypothesisMap& map,
                                        const FilterParams& filter,
                                        bool geometric,
                                        const RunControl& control) override {
    UseDevice();
    const PixelState state = Upload(map, Read::kPlanes);
    std::vector<uint32_t> consistent(map.planes.size());
    consistent_.Reserve(consistent.size());
    for (const Sweep& sweep : ConsistencySweeps(filter, geometric)) {
      RunSweep(sweep, state, consistent_.data(), control);
    }
    Finish();
    consistent_.Download(consistent.data(), consistent.size(), stream());
    Wait("copying masks from the card");
    return consistent;
  }

  std::vector<float> Score(const std::vector<PixelPlane>& planes,
                           const RunControl& control) override {
    std::vector<float> costs(planes.size());
    if (planes.empty()) return costs;
    control.cancel->ThrowIfCancelled();
    UseDevice();
    PhaseTimer timer(&seconds_, "score");
    pixel_planes_.Upload(planes, uploader());
    const ScoreLaunch launch = {&tables_.problem,
                                pixel_planes_.data(),
                                planes.size(),
                                pixel_costs_.Reserve(planes.size())};
    if (options_.format == ImageFormat::kQuad) {
      LaunchQuadScore(launch, stream());
    } else {
      LaunchTextureScore(launch, stream());
    }
    pixel_costs_.Download(costs.data(), costs.size(), stream());
    Wait("scoring planes");
    num_evaluations_ += planes.size() * tables_.problem.params.num_views;
    return costs;
  }

  uint64_t num_cost_evaluations() const override { return num_evaluations_; }
  // "upload", "download" and "score" are of the host's clock.
  std::map<std::string, double> DeviceSeconds() const override {
    return seconds_;
  }
  double longest_launch() const override { return longest_launch_; }

 private:
  // The current device belongs to the thread.
  void UseDevice() const {
    CheckCuda(cudaSetDevice(options_.device), "choosing the device");
  }
  cudaStream_t stream() const { return queue_->stream(); }
  Uploader* uploader() { return &*uploader_; }
  void Wait(const char* doing) const {
    CheckCuda(cudaStreamSynchronize(stream()), doing);
  }

  PixelState Upload(const HypothesisMap& map, Read read) {
    PhaseTimer timer(&seconds_, "upload");
    const size_t size = map.planes.size();
    PixelState state = {map.width,
                        map.height,
                        planes_.Reserve(size),
                        costs_.Reserve(size),
                        masks_.Reserve(size),
                        nullptr};
    if (resident_ == 0 || resident_ != map.generation) {
      if (read != Read::kNothing) planes_.Upload(map.planes, uploader());
      if (read == Read::kAll) {
        costs_.Upload(map.costs, uploader());
        masks_.Upload(map.masks, uploader());
      }
    }
    resident_ = 0;
    if (!map.priors.empty() && map.prior_level == 0) {
      priors_.Upload(map.priors, uploader());
      state.priors = priors_.data();
    } else if (!map.priors.empty()) {
      low_priors_.Upload(map.priors, uploader());
      LaunchUpsample(tables_.problem,
                     low_priors_.data(),
                     map.prior_level,
                     priors_.Reserve(size),
                     stream());
      state.priors = priors_.data();
    }
    if (!map.visits.empty()) {
      visits_.Upload(map.visits, uploader());
      state.visits = visits_.data();
    }
    const unsigned long long zero = 0;
    counter_.Upload(&zero, 1, uploader());
    return state;
  }

  Band BandOf(const PixelState& state,
              int color,
              int first_row,
              int num_rows) const {
    return {state.width,
            state.height,
            first_row,
            num_rows,
            color,
            options_.log_tile_width};
  }

  void RunSweep(const Sweep& sweep,
                const PixelState& state,
                uint32_t* consistent,
                const RunControl& control) {
    DeviceProblem problem = tables_.problem;
    problem.params.geometric = sweep.geometric;
    SweepLaunch launch = {};
    launch.problem = &problem;
    launch.sweep = sweep;
    launch.state = state;
    launch.consistent = consistent;
    launch.num_evaluations = counter_.data();
    for (int row = 0; row < state.height;) {
      if (control.cancel->cancelled()) {
        queue_->Abandon();
        Wait("stopping");
        control.cancel->ThrowIfCancelled();
      }
      launch.band = BandOf(state, sweep.color, row, 1);
      launch.band.num_rows = planner_.NextRows(
          sweep.kind, state.height - row, launch.band.tile_height());
      queue_->Add(
          sweep.kind,
          launch.band.num_rows,
          [&] {
            if (options_.format == ImageFormat::kQuad) {
              LaunchQuadSweep(launch, stream());
            } else {
              LaunchTextureSweep(launch, stream());
            }
          },
          [this](SweepKind kind, int rows, double taken) {
            Report(kind, rows, taken);
          });
      row += launch.band.num_rows;
    }
  }

  void Report(SweepKind kind, int num_rows, double taken) {
    planner_.Report(kind, num_rows, taken);
    seconds_[PhaseOf(kind)] += taken;
    longest_launch_ = std::max(longest_launch_, taken);
  }

  void Finish() {
    queue_->FinishAll([this](SweepKind kind, int rows, double taken) {
      Report(kind, rows, taken);
    });
    unsigned long long count = 0;
    counter_.Download(&count, 1, stream());
    Wait("running kernels");
    num_evaluations_ += count;
  }

  CudaOptions options_;
  std::string name_;
  std::optional<LaunchQueue> queue_;
  std::optional<Uploader> uploader_;
  std::optional<DeviceImages> images_;
  BandPlanner planner_;
  ProblemTables tables_;
  uint64_t random_key_ = 0;
  DeviceBuffer<float> color_weights_;
  DeviceBuffer<ViewGeometry> views_;
  DeviceBuffer<DepthView> depth_views_;
  DeviceBuffer<Vec3f> src_centers_;
  DeviceBuffer<Plane> planes_, priors_, low_priors_;
  DeviceBuffer<float> costs_;
  DeviceBuffer<uint8_t> visits_;
  DeviceBuffer<PixelPlane> pixel_planes_;
  DeviceBuffer<float> pixel_costs_;
  DeviceBuffer<uint32_t> masks_, consistent_;
  DeviceBuffer<unsigned long long> counter_;
  // HypothesisMap::generation of what the card holds; 0: of nothing.
  uint64_t resident_ = 0;
  uint64_t num_evaluations_ = 0;
  std::map<std::string, double> seconds_;
  double longest_launch_ = 0;
};

}  // namespace

std::unique_ptr<CudaBackend> MakeCudaBackend(const CudaOptions& options) {
  return std::make_unique<CudaBackendImpl>(options);
}

}  // namespace hpm
