#include "tests/cuda/made_up_card.h"

#include "cuda/check.h"
#include "cuda/launch.h"
#include "src/gpu/upsampled_prior.h"
#include "tests/gpu/host_launch.h"

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <vector>

namespace hpm {
namespace {

constexpr int kNumKinds = static_cast<int>(CardCall::kAny) + 1;

struct Failure {
  CardCall kind;
  int number = -1;  // none
  cudaError_t error = cudaSuccess;
  bool for_good = false;
};

std::mutex mutex;
std::array<int, kNumKinds> num_calls = {};
Failure failure;
bool is_lost = false;
bool is_idle = false;
int num_live = 0;
size_t num_sent = 0;
cudaError_t last_error = cudaSuccess;

int& CountOf(CardCall kind) { return num_calls[static_cast<int>(kind)]; }

// What a call of this kind returns.
cudaError_t Called(CardCall kind) {
  const std::lock_guard<std::mutex> lock(mutex);
  bool fails = is_lost;
  for (const CardCall counted : {kind, CardCall::kAny}) {
    const int number = CountOf(counted)++;
    if (counted == failure.kind && number == failure.number) {
      fails = true;
      is_lost = failure.for_good;
    }
    if (kind == CardCall::kAny) break;
  }
  if (fails) last_error = failure.error;
  return fails ? failure.error : cudaSuccess;
}

void CountSent(size_t size) {
  const std::lock_guard<std::mutex> lock(mutex);
  num_sent += size;
}

// Memory of the card holds rubbish until something is written.
void* NewMemory(size_t size) {
  void* memory = std::malloc(size);
  std::memset(memory, 0xA5, size);
  const std::lock_guard<std::mutex> lock(mutex);
  ++num_live;
  return memory;
}

void FreeMemory(void* memory) {
  std::free(memory);
  const std::lock_guard<std::mutex> lock(mutex);
  --num_live;
}

struct Array {
  int width, height;
  uint8_t* data;
  const uint8_t* layer(int j) const {
    return data + static_cast<size_t>(j) * width * height;
  }
};

// Streams and events are counted as memory is.
template <class Handle>
cudaError_t MakeHandle(Handle* handle) {
  const cudaError_t status = Called(CardCall::kAny);
  if (status == cudaSuccess) *handle = static_cast<Handle>(NewMemory(1));
  return status;
}

void CheckLaunch() {
  CheckCuda(Called(CardCall::kLaunch), "starting a kernel");
}

// The problem with texels in every view, from its texture if it has one.
class OnHost {
 public:
  explicit OnHost(const DeviceProblem& problem)
      : problem_(problem),
        views_(problem.views, problem.views + problem.params.num_views) {
    const auto* array = reinterpret_cast<const Array*>(problem.texture);
    for (size_t j = 0; array != nullptr && j < views_.size(); ++j) {
      ViewGeometry& view = views_[j];
      texels_.push_back(TexelsOf(array->layer(static_cast<int>(j)),
                                 array->width,
                                 view.width,
                                 view.height));
      view.texels = texels_.back().data();
    }
    problem_.views = views_.data();
  }
  const DeviceProblem& problem() const { return problem_; }

 private:
  DeviceProblem problem_;
  std::vector<ViewGeometry> views_;
  std::vector<std::vector<uint32_t>> texels_;
};

void Sweep1(const SweepLaunch& launch) {
  CheckLaunch();
  if (is_idle) return;
  *launch.num_evaluations += RunBand(EmulatedCost::kCore,
                                     OnHost(*launch.problem).problem(),
                                     launch.sweep,
                                     launch.state,
                                     launch.consistent,
                                     launch.band);
}

void Score1(const ScoreLaunch& launch) {
  CheckLaunch();
  if (is_idle) return;
  const OnHost host(*launch.problem);
  uint64_t count = 0;
  for (size_t i = 0; i < launch.num_planes; ++i) {
    launch.costs[i] = ScoreOnHost(
        EmulatedCost::kCore, host.problem(), launch.planes[i], &count);
  }
}

}  // namespace

void StartCounting() {
  const std::lock_guard<std::mutex> lock(mutex);
  num_calls = {};
  failure = {};
  is_lost = false;
  num_sent = 0;
}

int CallsOf(CardCall kind) { return CountOf(kind); }

size_t BytesSent() { return num_sent; }

void LetCallFail(CardCall kind, int number, cudaError_t error, bool for_good) {
  StartCounting();
  failure = {kind, number, error, for_good};
}

void LetKernelsIdle(bool idle) { is_idle = idle; }

int LiveAllocations() { return num_live; }

void LaunchTextureSweep(const SweepLaunch& launch, cudaStream_t) {
  Sweep1(launch);
}
void LaunchQuadSweep(const SweepLaunch& launch, cudaStream_t) {
  Sweep1(launch);
}
void LaunchTextureScore(const ScoreLaunch& launch, cudaStream_t) {
  Score1(launch);
}
void LaunchQuadScore(const ScoreLaunch& launch, cudaStream_t) {
  Score1(launch);
}

void LaunchUpsample(const DeviceProblem& problem,
                    const Plane* low,
                    int level,
                    Plane* planes,
                    cudaStream_t) {
  CheckLaunch();
  const Camera& ref = problem.params.ref;
  for (int row = 0; row < ref.height; ++row) {
    for (int col = 0; col < ref.width; ++col)
      *planes++ = UpsampledPriorAt(problem, low, level, col, row);
  }
}

void LaunchPackTexels(const uint8_t* grey,
                      int width,
                      int height,
                      uint32_t* texels,
                      cudaStream_t) {
  CheckLaunch();
  const std::vector<uint32_t> packed = TexelsOf(grey, width, width, height);
  std::copy(packed.begin(), packed.end(), texels);
}

void LaunchFillLayer(const uint8_t* grey,
                     int width,
                     int height,
                     int layer_width,
                     int layer_height,
                     uint8_t* layer,
                     cudaStream_t) {
  CheckLaunch();
  for (int row = 0; row < layer_height; ++row) {
    for (int col = 0; col < layer_width; ++col) {
      *layer++ =
          grey[std::min(row, height - 1) * width + std::min(col, width - 1)];
    }
  }
}

}  // namespace hpm

// The CUDA runtime, as far as cuda/ calls it.
using hpm::Called;
using hpm::CardCall;

extern "C" {

cudaError_t cudaSetDevice(int) { return Called(CardCall::kAny); }
#undef cudaGetDeviceProperties
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int) {
  *properties = {};
  std::strcpy(properties->name, "made up");
  return Called(CardCall::kAny);
}

cudaError_t cudaMalloc(void** memory, size_t size) {
  const cudaError_t status = Called(CardCall::kAllocate);
  *memory = status == cudaSuccess ? hpm::NewMemory(size) : nullptr;
  return status;
}
cudaError_t cudaFree(void* memory) {
  hpm::FreeMemory(memory);
  return cudaSuccess;
}
cudaError_t cudaMallocHost(void** memory, size_t size) {
  const cudaError_t status = Called(CardCall::kLock);
  *memory = status == cudaSuccess ? hpm::NewMemory(size) : nullptr;
  return status;
}
cudaError_t cudaFreeHost(void* memory) { return cudaFree(memory); }

cudaError_t cudaMalloc3DArray(cudaArray_t* array,
                              const cudaChannelFormatDesc*,
                              cudaExtent extent,
                              unsigned) {
  const cudaError_t status = Called(CardCall::kAllocate);
  if (status != cudaSuccess) return status;
  *array = reinterpret_cast<cudaArray_t>(new hpm::Array{
      static_cast<int>(extent.width),
      static_cast<int>(extent.height),
      static_cast<uint8_t*>(
          hpm::NewMemory(extent.width * extent.height * extent.depth))});
  return cudaSuccess;
}
cudaError_t cudaFreeArray(cudaArray_t array) {
  const auto* made_up = reinterpret_cast<hpm::Array*>(array);
  hpm::FreeMemory(made_up->data);
  delete made_up;
  return cudaSuccess;
}
cudaError_t cudaMemcpy3DAsync(const cudaMemcpy3DParms* copy, cudaStream_t) {
  const cudaError_t status = Called(CardCall::kAny);
  if (status != cudaSuccess) return status;
  const auto* array = reinterpret_cast<const hpm::Array*>(copy->dstArray);
  std::memcpy(
      const_cast<uint8_t*>(array->layer(static_cast<int>(copy->dstPos.z))),
      copy->srcPtr.ptr,
      copy->extent.width * copy->extent.height);
  return cudaSuccess;
}
cudaChannelFormatDesc cudaCreateChannelDesc(
    int x, int y, int z, int w, cudaChannelFormatKind kind) {
  return {x, y, z, w, kind};
}
cudaError_t cudaCreateTextureObject(cudaTextureObject_t* texture,
                                    const cudaResourceDesc* resource,
                                    const cudaTextureDesc*,
                                    const cudaResourceViewDesc*) {
  *texture = reinterpret_cast<cudaTextureObject_t>(resource->res.array.array);
  return Called(CardCall::kAny);
}
cudaError_t cudaDestroyTextureObject(cudaTextureObject_t) {
  return cudaSuccess;
}

cudaError_t cudaMemcpyAsync(void* to,
                            const void* from,
                            size_t size,
                            cudaMemcpyKind kind,
                            cudaStream_t) {
  const cudaError_t status = Called(CardCall::kAny);
  if (kind == cudaMemcpyHostToDevice) hpm::CountSent(size);
  if (status == cudaSuccess) std::memcpy(to, from, size);
  return status;
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned) {
  return hpm::MakeHandle(stream);
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  hpm::FreeMemory(stream);
  return cudaSuccess;
}
cudaError_t cudaStreamSynchronize(cudaStream_t) {
  return Called(CardCall::kAny);
}
cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) {
  return hpm::MakeHandle(event);
}
cudaError_t cudaEventDestroy(cudaEvent_t event) {
  hpm::FreeMemory(event);
  return cudaSuccess;
}
cudaError_t cudaEventRecord(cudaEvent_t, cudaStream_t) {
  return Called(CardCall::kAny);
}
cudaError_t cudaEventSynchronize(cudaEvent_t) { return Called(CardCall::kAny); }
cudaError_t cudaEventElapsedTime(float* milliseconds,
                                 cudaEvent_t,
                                 cudaEvent_t) {
  *milliseconds = 1;
  return Called(CardCall::kAny);
}

cudaError_t cudaGetLastError() {
  const cudaError_t status = hpm::last_error;
  hpm::last_error = cudaSuccess;
  return status;
}
const char* cudaGetErrorString(cudaError_t) { return "made-up error"; }
const char* cudaGetErrorName(cudaError_t) { return "cudaErrorMadeUp"; }

}  // extern "C"
