// Memory and disk a run will take, known before it starts.
#pragma once

#include "colmap_plugin/controller/stages.h"
#include "src/engine/backend.h"
#include "src/gpu/memory_estimate.h"

#include <cstdint>
#include <vector>

namespace hpm {

// Largest need over all problems, in bytes.
struct MemoryNeeds {
  uint64_t working = 0;  // per image in flight: of the backend, maps read back,
                         // and the decoder of one file
  uint64_t inputs = 0;   // images and depth maps of one problem
  uint64_t decoding = 0;  // of `working`: the decoder
};

// While the image's file is decoded, at the scale it is decoded at, or its
// mask.
uint64_t DecodedBytes(const Workspace& workspace, int image);

// How many threads may decode files of at most so many bytes (as above) at once
// while nothing else is in memory.
int ThreadsToDecode(uint64_t largest_bytes);

// Whichever of `backends` computes.
MemoryNeeds LargestNeeds(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const std::vector<const Backend*>& backends,
                         bool geometric);

// The largest of all sizes, for memory on a GPU.
ProblemSize LargestProblem(const Workspace& workspace,
                           const std::vector<StereoProblem>& problems,
                           bool geometric);

// How many of `most` images may be worked on at once in half of `limit` bytes;
// at least 1. PlanCacheBytes() refuses no more than one.
int ImagesInMemory(const MemoryNeeds& needs, int most, uint64_t limit);

// How many files an image in flight may decode at once: while it reads, what it
// needs to match and to write is free.
int DecodesAtOnce(const MemoryNeeds& needs);

// 2 where many threads would wait while one image is read or written and a
// second costs little memory. Else 1.
int CpuImagesInFlight(const MemoryNeeds& needs,
                      int num_threads,
                      uint64_t limit);

// Of --PatchMatchStereo.cache_size, which may be absurdly large.
uint64_t CacheBytes(double gibibytes);

uint64_t BytesToWrite(const std::vector<StereoProblem>& problems,
                      const StagePlan& plan);

}  // namespace hpm
