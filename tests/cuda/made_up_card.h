// A card that is not there: the functions of the CUDA runtime and the launches
// of cuda/launch.h, done by the host. With it cuda/cuda_backend.cc runs in the
// tests as it is, and every call of the runtime can be made to fail.
#pragma once

#include <cstddef>

#include <cuda_runtime_api.h>

namespace hpm {

enum class CardCall {
  kAllocate,  // cudaMalloc, cudaMalloc3DArray
  kLock,      // cudaMallocHost
  kLaunch,
  kAny,  // whatever can fail
};

// All calls are numbered by kind, from 0, since the last of these.
void StartCounting();
int CallsOf(CardCall kind);
// Copied from the host to the card since then.
size_t BytesSent();

// The `number`-th call of this kind from now on returns `error`, and with
// `for_good` every later one of any kind too.
void LetCallFail(CardCall kind, int number, cudaError_t error, bool for_good);

// Kernels report success and do nothing.
void LetKernelsIdle(bool idle);

// What was not given back: memory of the card, locked memory, streams, events.
int LiveAllocations();

}  // namespace hpm
