#include "cuda/device_images.h"

#include "cuda/launch.h"

#include <algorithm>

#include <cuda_runtime.h>

namespace hpm {

DeviceImages::~DeviceImages() { FreeTexture(); }

const uint32_t* DeviceImages::texels(int j) const {
  return format_ == ImageFormat::kQuad ? texels_[j].data() : nullptr;
}

void DeviceImages::Upload(const ViewSet& views, Uploader* uploader) {
  cudaStream_t stream = uploader->stream();
  const int num_srcs = static_cast<int>(views.srcs.size());
  ref_.Upload(views.ref.image->data, uploader);
  int width = 1, height = 1;
  for (const View& src : views.srcs) {
    width = std::max(width, src.image->width);
    height = std::max(height, src.image->height);
  }
  const bool quad = format_ == ImageFormat::kQuad;
  if (quad) {
    texels_.resize(num_srcs);
  } else {
    MakeTexture(width, height, num_srcs);
  }
  for (int j = 0; j < num_srcs; ++j) {
    const GrayImage& image = *views.srcs[j].image;
    grey_.Upload(image.data, uploader);
    if (quad) {
      LaunchPackTexels(grey_.data(),
                       image.width,
                       image.height,
                       texels_[j].Reserve(image.data.size()),
                       stream);
      continue;
    }
    uint8_t* layer = layer_.Reserve(static_cast<size_t>(width) * height);
    LaunchFillLayer(
        grey_.data(), image.width, image.height, width, height, layer, stream);
    cudaMemcpy3DParms copy = {};
    copy.srcPtr = make_cudaPitchedPtr(layer, width, width, height);
    copy.dstArray = array_;
    copy.dstPos = make_cudaPos(0, 0, j);
    copy.extent = make_cudaExtent(width, height, 1);
    copy.kind = cudaMemcpyDeviceToDevice;
    CheckCuda(cudaMemcpy3DAsync(&copy, stream), "filling a texture");
  }

  depths_.resize(num_srcs);
  inverse_depths_.assign(num_srcs, {nullptr, 0});
  for (int j = 0; j < num_srcs; ++j) {
    if (views.srcs[j].inverse_depth == nullptr) continue;
    const InverseDepthMap& map = *views.srcs[j].inverse_depth;
    depths_[j].Upload(map.steps, uploader);
    inverse_depths_[j] = {depths_[j].data(), map.step};
  }
}

void DeviceImages::MakeTexture(int width, int height, int num_layers) {
  if (texture_ != 0 && width == width_ && height == height_ &&
      num_layers == num_layers_) {
    return;
  }
  FreeTexture();
  const cudaChannelFormatDesc channels =
      cudaCreateChannelDesc(8, 0, 0, 0, cudaChannelFormatKindUnsigned);
  CheckCuda(cudaMalloc3DArray(&array_,
                              &channels,
                              make_cudaExtent(width, height, num_layers),
                              cudaArrayLayered),
            "reserving textures");
  cudaResourceDesc resource = {};
  resource.resType = cudaResourceTypeArray;
  resource.res.array.array = array_;
  cudaTextureDesc description = {};
  description.addressMode[0] = cudaAddressModeClamp;
  description.addressMode[1] = cudaAddressModeClamp;
  description.filterMode = cudaFilterModeLinear;
  description.readMode = cudaReadModeNormalizedFloat;
  CheckCuda(
      cudaCreateTextureObject(&texture_, &resource, &description, nullptr),
      "making a texture");
  width_ = width;
  height_ = height;
  num_layers_ = num_layers;
}

void DeviceImages::FreeTexture() {
  if (texture_ != 0) cudaDestroyTextureObject(texture_);
  if (array_ != nullptr) cudaFreeArray(array_);
  texture_ = 0;
  array_ = nullptr;
}

}  // namespace hpm
