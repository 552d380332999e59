// Memory of the card that lives as long as its object.
#pragma once

#include "cuda/check.h"
#include "cuda/uploader.h"

#include <cstddef>
#include <utility>

namespace hpm {

// Uninitialised room for elements; grows and never shrinks, so that image after
// image of the same size allocates nothing.
template <class T>
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  ~DeviceBuffer() { Free(); }
  DeviceBuffer(DeviceBuffer&& other) noexcept { Swap(&other); }
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    Swap(&other);
    return *this;
  }

  T* data() const { return data_; }

  // The elements are lost if the room must grow.
  T* Reserve(size_t size) {
    if (size > size_) {
      Free();
      CheckCuda(cudaMalloc(reinterpret_cast<void**>(&data_), size * sizeof(T)),
                "reserving memory");
      size_ = size;
    }
    return data_;
  }

  // `from` may be changed when this returns.
  void Upload(const T* from, size_t size, Uploader* uploader) {
    uploader->Copy(Reserve(size), from, size * sizeof(T));
  }
  template <class Vector>
  void Upload(const Vector& from, Uploader* uploader) {
    Upload(from.data(), from.size(), uploader);
  }

  void Download(T* to, size_t size, cudaStream_t stream) const {
    CheckCuda(cudaMemcpyAsync(
                  to, data_, size * sizeof(T), cudaMemcpyDeviceToHost, stream),
              "copying from the card");
  }

  void Free() {
    if (data_ != nullptr) cudaFree(data_);
    data_ = nullptr;
    size_ = 0;
  }

 private:
  void Swap(DeviceBuffer* other) {
    std::swap(data_, other->data_);
    std::swap(size_, other->size_);
  }

  T* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace hpm
