// The images and depth maps of a problem on the card.
#pragma once

#include "cuda/device_memory.h"
#include "src/engine/view.h"
#include "src/gpu/samplers.h"

#include <cstdint>
#include <vector>

namespace hpm {

class DeviceImages {
 public:
  explicit DeviceImages(ImageFormat format) : format_(format) {}
  ~DeviceImages();
  DeviceImages(const DeviceImages&) = delete;
  DeviceImages& operator=(const DeviceImages&) = delete;

  // Replaces what was there.
  void Upload(const ViewSet& views, Uploader* uploader);

  const uint8_t* ref_grey() const { return ref_.data(); }
  // Of source view j; null unless the format is kQuad.
  const uint32_t* texels(int j) const;
  // 0 if the format is kQuad.
  cudaTextureObject_t texture() const { return texture_; }
  // Of source view j.
  const InverseDepths& inverse_depths(int j) const {
    return inverse_depths_[j];
  }

 private:
  void MakeTexture(int width, int height, int num_layers);
  void FreeTexture();

  ImageFormat format_;
  DeviceBuffer<uint8_t> ref_, grey_, layer_;
  std::vector<DeviceBuffer<uint32_t>> texels_;
  std::vector<DeviceBuffer<uint8_t>> depths_;
  std::vector<InverseDepths> inverse_depths_;
  cudaArray_t array_ = nullptr;
  cudaTextureObject_t texture_ = 0;
  int width_ = 0, height_ = 0, num_layers_ = 0;  // of array_
};

}  // namespace hpm
