#include "colmap_plugin/controller/devices.h"

#include "cuda/cuda_backend.h"
#include "src/base/error.h"
#include "src/gpu/self_test.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

// While one image computes, others are read, have their priors built and are
// written; a fast card waits for the host, so as many as the host has cores
// for (docs/gpu.md).
int MostImagesPerEntry(int num_threads) {
  constexpr int kLeast = 3, kMost = 8, kThreadsPerImage = 2;
  return std::clamp(num_threads / kThreadsPerImage, kLeast, kMost);
}

const CudaDevice* FindDevice(const std::vector<CudaDevice>& devices,
                             int index) {
  for (const CudaDevice& device : devices) {
    if (device.index == index) return &device;
  }
  return nullptr;
}

// Throws what keeps the device from being used.
std::unique_ptr<Backend> OpenTested(const GpuAccess& gpus,
                                    const CudaDevice& device) {
  std::unique_ptr<Backend> backend = gpus.open(device.index);
  const std::string failure = SelfTestFailure(backend.get());
  if (!failure.empty()) {
    throw Error(
        ErrorCode::kDevice,
        fmt::format(
            "GPU {} ({}) is not used: {}", device.index, device.name, failure));
  }
  return backend;
}

}  // namespace

std::vector<int> ParseGpuIndex(const std::string& list, int num_devices) {
  std::vector<int> entries;
  std::stringstream stream(list);
  for (std::string entry; std::getline(stream, entry, ',');) {
    const int index = std::atoi(entry.c_str());  // the option table checked it
    if (index < 0) {
      entries.clear();
      for (int i = 0; i < num_devices; ++i) entries.push_back(i);
      return entries;
    }
    if (index >= num_devices) {
      throw Error(
          ErrorCode::kDevice,
          fmt::format("--PatchMatchStereo.gpu_index {}: there is no GPU "
                      "{}, this machine has {}",
                      list,
                      index,
                      num_devices));
    }
    entries.push_back(index);
  }
  return entries;
}

GpuAccess RealGpus() {
  GpuAccess gpus;
  gpus.find = FindCudaDevices;
  gpus.open = [](int device) -> std::unique_ptr<Backend> {
    CudaOptions options;
    options.device = device;
    return MakeCudaBackend(options);
  };
  return gpus;
}

std::vector<std::unique_ptr<Backend>> OpenGpus(const ControllerOptions& options,
                                               const ProblemSize& largest,
                                               int num_images,
                                               int num_threads,
                                               const GpuAccess& gpus,
                                               const LogSink& log) {
  if (options.hpm.device == "cpu") return {};
  const bool must = options.hpm.device == "cuda";
  std::string why_none;
  const std::vector<CudaDevice> devices = gpus.find(&why_none);
  if (devices.empty()) {
    if (must) {
      throw Error(ErrorCode::kDevice,
                  "--Hpm.device cuda: no GPU can be used: " + why_none +
                      "; set --Hpm.device cpu");
    }
    log(LogLevel::kInfo, "No GPU is used (" + why_none + ")");
    return {};
  }
  int num_indices = 0;
  for (const CudaDevice& device : devices) {
    num_indices = std::max(num_indices, device.index + 1);
  }
  const std::vector<int> indices =
      ParseGpuIndex(options.patch_match.gpu_index, num_indices);
  std::map<int, int> num_entries;
  for (const int index : indices) ++num_entries[index];
  const int most =
      options.hpm.gpu_images > 0
          ? options.hpm.gpu_images
          : MostImagesPerEntry(num_threads / static_cast<int>(indices.size()));
  // With the number of the image on its card.
  std::vector<std::pair<int, std::unique_ptr<Backend>>> opened;
  for (const auto& [index, entries] : num_entries) {
    const CudaDevice* device = FindDevice(devices, index);
    try {
      if (device == nullptr) {
        throw Error(ErrorCode::kDevice,
                    fmt::format("GPU {} is not used: {}", index, why_none));
      }
      const int fit = ImagesThatFit(largest,
                                    ImageFormat::kByte,
                                    device->free_bytes,
                                    device->num_processors,
                                    most * entries);
      if (fit == 0) {
        throw Error(
            ErrorCode::kOutOfResources,
            fmt::format(
                "GPU {} ({}) is not used: an image needs about {} MB and {} "
                "MB are free; set a smaller --PatchMatchStereo.max_image_size",
                index,
                device->name,
                (DeviceBytesNeeded(largest, ImageFormat::kByte) +
                 DeviceOverheadBytes(device->num_processors)) >>
                    20,
                device->free_bytes >> 20));
      }
      opened.emplace_back(0, OpenTested(gpus, *device));
      for (int i = 1; i < fit; ++i) opened.emplace_back(i, gpus.open(index));
    } catch (const Error& error) {
      if (must) throw;
      log(LogLevel::kWarning, error.what());
    }
  }
  // In turn, so that fewer images are shared out among the cards.
  std::stable_sort(
      opened.begin(), opened.end(), [](const auto& a, const auto& b) {
        return a.first < b.first;
      });
  if (static_cast<int>(opened.size()) > std::max(num_images, 1))
    opened.resize(std::max(num_images, 1));
  std::vector<std::unique_ptr<Backend>> backends;
  backends.reserve(opened.size());
  for (auto& [number, backend] : opened) backends.push_back(std::move(backend));
  return backends;
}

}  // namespace hpm
