#include "colmap_plugin/controller/run_budget.h"

#include "colmap_plugin/workspace/output_check.h"
#include "src/engine/memory_plan.h"

#include <algorithm>

#include <tbb/task_arena.h>

namespace hpm {

namespace {

uint64_t BytesOfSample(SampleDepth depth) {
  switch (depth) {
    case SampleDepth::k8:
      return 1;
    case SampleDepth::k16:
      return 2;
    case SampleDepth::kOther:
      break;
  }
  return 4;
}

// The file, its samples and 0 or 255 for each, never at a reduced scale.
uint64_t DecodedMaskBytes(const std::optional<ImageSize>& size) {
  if (!size) return 0;
  return size->file_bytes + (BytesOfSample(size->depth) + 1) *
                                static_cast<uint64_t>(size->width) *
                                static_cast<uint64_t>(size->height);
}

}  // namespace

uint64_t DecodedBytes(const Workspace& workspace, int image) {
  const std::optional<ImageSize>& size = workspace.file_size(image);
  if (!size) return 0;
  const ImageDecoding decoding = workspace.Decoding(image);
  // Three samples (four of deep files, which may have alpha), and grey.
  uint64_t bytes_per_pixel = 3 + 1;
  if (size->depth != SampleDepth::k8)
    bytes_per_pixel = 4 * BytesOfSample(size->depth) + sizeof(float);
  const auto decoded = [&](int side) {
    return static_cast<uint64_t>((side + decoding.reduction - 1) /
                                 decoding.reduction);
  };
  const uint64_t bytes = size->file_bytes + bytes_per_pixel *
                                                decoded(size->width) *
                                                decoded(size->height);
  // One after the other.
  return std::max(bytes, DecodedMaskBytes(workspace.mask_size(image)));
}

int ThreadsToDecode(uint64_t largest_bytes) {
  const uint64_t most =
      MemoryLimit() / 4 / std::max<uint64_t>(largest_bytes, 1);
  return static_cast<int>(std::clamp<uint64_t>(
      most, 1, static_cast<uint64_t>(tbb::this_task_arena::max_concurrency())));
}

MemoryNeeds LargestNeeds(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const std::vector<const Backend*>& backends,
                         bool geometric) {
  const auto pixels_of = [&](int image) {
    const Camera& camera = workspace.camera(image);
    return static_cast<uint64_t>(camera.width) * camera.height;
  };
  MemoryNeeds needs;
  for (const StereoProblem& problem : problems) {
    const Camera& ref = workspace.camera(problem.ref_image);
    const uint64_t ref_pixels = pixels_of(problem.ref_image);
    uint64_t inputs = ref_pixels;
    uint64_t decoded = DecodedBytes(workspace, problem.ref_image);
    for (const int src : problem.src_images) {
      decoded = std::max(decoded, DecodedBytes(workspace, src));
      inputs += pixels_of(src) * (geometric ? 1 + kInverseDepthBytes : 1);
    }
    // For previews, consistency graphs, confidence and cuts to a range.
    const uint64_t maps_read_back = ref_pixels * 4 * sizeof(float);
    for (const Backend* backend : backends) {
      const uint64_t matching = backend->MemoryNeeded(
          ref.width, ref.height, static_cast<int>(problem.src_images.size()));
      needs.working =
          std::max(needs.working, matching + maps_read_back + decoded);
    }
    needs.inputs = std::max(needs.inputs, inputs);
    needs.decoding = std::max(needs.decoding, decoded);
  }
  return needs;
}

ProblemSize LargestProblem(const Workspace& workspace,
                           const std::vector<StereoProblem>& problems,
                           bool geometric) {
  ProblemSize size = {1, 1, 1, 1, 1, geometric};
  for (const StereoProblem& problem : problems) {
    const Camera& ref = workspace.camera(problem.ref_image);
    size.width = std::max(size.width, ref.width);
    size.height = std::max(size.height, ref.height);
    for (const int src : problem.src_images) {
      const Camera& camera = workspace.camera(src);
      size.src_width = std::max(size.src_width, camera.width);
      size.src_height = std::max(size.src_height, camera.height);
    }
    size.num_srcs =
        std::max(size.num_srcs, static_cast<int>(problem.src_images.size()));
  }
  return size;
}

int ImagesInMemory(const MemoryNeeds& needs, int most, uint64_t limit) {
  const uint64_t bytes =
      std::min(limit / 2, limit - std::min(limit, kOverheadBytes));
  const uint64_t fit =
      bytes / std::max<uint64_t>(needs.working + needs.inputs, 1);
  return static_cast<int>(std::clamp<uint64_t>(fit, 1, std::max(most, 1)));
}

int DecodesAtOnce(const MemoryNeeds& needs) {
  // Decoders of progressive files take about twice as much again, and the
  // hypotheses of the image before stay.
  constexpr uint64_t kWithDecoder = 4;
  constexpr uint64_t kMost = 8;
  const uint64_t fit =
      needs.working / std::max<uint64_t>(kWithDecoder * needs.decoding, 1);
  return static_cast<int>(std::clamp<uint64_t>(fit, 1, kMost));
}

int CpuImagesInFlight(const MemoryNeeds& needs,
                      int num_threads,
                      uint64_t limit) {
  constexpr uint64_t kLittleBytes = 256ull << 20;
  constexpr int kManyThreads = 4;
  if (num_threads < kManyThreads || needs.working > kLittleBytes) return 1;
  return ImagesInMemory(needs, 2, limit);
}

uint64_t CacheBytes(double gibibytes) {
  constexpr double kMaxGibibytes = 1 << 20;
  return static_cast<uint64_t>(std::min(gibibytes, kMaxGibibytes) *
                               (1ull << 30));
}

uint64_t BytesToWrite(const std::vector<StereoProblem>& problems,
                      const StagePlan& plan) {
  uint64_t bytes = 0;
  for (int s = 0; s < static_cast<int>(plan.stages().size()); ++s) {
    for (int p = 0; p < static_cast<int>(problems.size()); ++p) {
      if (!plan.IsNeeded(s, p)) continue;
      const int image = problems[p].ref_image;
      const Camera camera = plan.CameraOf(s, image);
      bytes += DepthAndNormalMapBytes(camera);
      if (plan.WritesConfidence(s, image))
        bytes +=
            sizeof(float) * static_cast<uint64_t>(camera.width) * camera.height;
    }
  }
  return bytes;
}

}  // namespace hpm
