// Copies from the host's memory to the card's in one stream. The driver copies
// from ordinary memory through buffers of its own, one thread at a time; this
// one has its own, so that several images in flight do not wait for each other.
#pragma once

#include "cuda/check.h"
#include "cuda/events.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace hpm {

class Uploader {
 public:
  // Host memory that an uploader holds.
  static constexpr size_t kBytes = size_t{8} << 20;

  explicit Uploader(cudaStream_t stream) : stream_(stream) {}
  Uploader(const Uploader&) = delete;
  Uploader& operator=(const Uploader&) = delete;

  cudaStream_t stream() const { return stream_; }

  // `from` may be changed when this returns.
  void Copy(void* to, const void* from, size_t num_bytes) {
    for (size_t done = 0; done < num_bytes;) {
      Buffer& buffer = buffers_[next_++ % buffers_.size()];
      const size_t size = std::min(kChunk, num_bytes - done);
      const char* source = static_cast<const char*>(from) + done;
      if (buffer.data != nullptr) {
        CheckCuda(cudaEventSynchronize(buffer.sent.get()),
                  "copying to the card");
        std::memcpy(buffer.data, source, size);
        source = static_cast<const char*>(buffer.data);
      }
      CheckCuda(cudaMemcpyAsync(static_cast<char*>(to) + done,
                                source,
                                size,
                                cudaMemcpyHostToDevice,
                                stream_),
                "copying to the card");
      CheckCuda(cudaEventRecord(buffer.sent.get(), stream_),
                "copying to the card");
      done += size;
    }
  }

 private:
  static constexpr size_t kNumBuffers = 2;
  static constexpr size_t kChunk = kBytes / kNumBuffers;

  struct Buffer {
    Buffer() {
      // Where the system grants no such memory, the driver has to do.
      if (cudaMallocHost(&data, kChunk) != cudaSuccess) {
        cudaGetLastError();
        data = nullptr;
      }
    }
    ~Buffer() {
      if (data != nullptr) cudaFreeHost(data);
    }
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;

    CudaEvent sent{cudaEventDisableTiming};
    void* data = nullptr;
  };

  cudaStream_t stream_;
  std::array<Buffer, kNumBuffers> buffers_;
  size_t next_ = 0;
};

}  // namespace hpm
