#include "colmap_plugin/controller/deep_images.h"

#include "colmap_plugin/controller/run_budget.h"
#include "colmap_plugin/formats/atomic_file.h"
#include "src/base/error.h"
#include "src/base/input_file.h"
#include "src/engine/memory_plan.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

// Some hundred thousand images.
constexpr uint64_t kMaxRecordBytes = 32 << 20;

struct DeepImage {
  int index = 0;
  std::string key;  // in the record of what was found; empty: none
  std::optional<GreyRange> range;
};

std::vector<DeepImage> DeepImagesOf(const Workspace& workspace,
                                    ImageContents* contents,
                                    const CancelToken& cancel) {
  std::vector<int> deep;
  for (int i = 0; i < workspace.num_images(); ++i) {
    const std::optional<ImageSize>& size = workspace.file_size(i);
    if (!workspace.usable(i) || !workspace.has_picture(i) || !size ||
        size->depth == SampleDepth::k8) {
      continue;
    }
    deep.push_back(i);
  }
  contents->Read(deep, cancel);
  std::vector<DeepImage> images;
  images.reserve(deep.size());
  for (const int image : deep)
    images.push_back({image, contents->HashOf(image), std::nullopt});
  return images;
}

fs::path RecordPath(const Workspace& workspace) {
  return workspace.StatePath() / "deep_images.json";
}

// Whatever is wrong with the record, the images are measured anew.
void ReadRecord(const Workspace& workspace, std::vector<DeepImage>* images) {
  std::string text;
  try {
    text = ReadWholeFile(RecordPath(workspace), kMaxRecordBytes);
  } catch (const Error&) {
    return;
  }
  const nlohmann::json json =
      nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return;
  for (DeepImage& image : *images) {
    const auto it = json.find(image.key);
    if (it == json.end() || !it->is_array() || it->size() != 2 ||
        !(*it)[0].is_number() || !(*it)[1].is_number())
      continue;
    image.range = GreyRange{(*it)[0], (*it)[1]};
  }
}

void WriteRecord(const Workspace& workspace,
                 const std::vector<DeepImage>& images) {
  nlohmann::json json = nlohmann::json::object();
  for (const DeepImage& image : images) {
    if (image.range && !image.key.empty())
      json[image.key] = {image.range->low, image.range->high};
  }
  WriteFileAtomically(RecordPath(workspace), json.dump(1) + "\n");
}

// False if there was nothing to do.
bool Measure(const Workspace& workspace,
             const CancelToken& cancel,
             std::vector<DeepImage>* images) {
  std::vector<DeepImage*> unknown;
  uint64_t largest = 0;
  for (DeepImage& image : *images) {
    const uint64_t bytes = DecodedBytes(workspace, image.index);
    // A bomb is not even tried.
    if (image.range || bytes > MemoryLimit()) continue;
    unknown.push_back(&image);
    largest = std::max(largest, bytes);
  }
  if (unknown.empty()) return false;
  tbb::task_arena(ThreadsToDecode(largest)).execute([&] {
    tbb::parallel_for(size_t{0}, unknown.size(), [&](size_t i) {
      cancel.ThrowIfCancelled();
      DeepImage* image = unknown[i];
      image->range = MeasureGreyRange(workspace.ImagePath(image->index));
    });
  });
  return true;
}

}  // namespace

std::optional<GreyRange> FindDeepRange(const Workspace& workspace,
                                       ImageContents* contents,
                                       const LogSink& log,
                                       const CancelToken& cancel,
                                       PlanAccess access) {
  std::vector<DeepImage> images = DeepImagesOf(workspace, contents, cancel);
  if (images.empty()) return std::nullopt;
  ReadRecord(workspace, &images);
  if (Measure(workspace, cancel, &images) && access == PlanAccess::kRun)
    WriteRecord(workspace, images);
  std::optional<GreyRange> range;
  bool can_be_cut = true;
  for (const DeepImage& image : images) {
    if (workspace.file_size(image.index)->depth == SampleDepth::kOther)
      can_be_cut = false;
    if (!image.range) continue;  // unreadable, or black: said when it is used
    if (!range) range = image.range;
    range->low = std::min(range->low, image.range->low);
    range->high = std::max(range->high, image.range->high);
  }
  constexpr double kHalfOf16Bits = 32767.5;
  if (can_be_cut && (!range || range->high - range->low >= kHalfOf16Bits))
    return std::nullopt;
  if (!range) range = GreyRange{0, 1};
  log(LogLevel::kInfo,
      fmt::format("{} images have more than 8 bits a sample; their grey values "
                  "from {:g} to {:g}, the range of all of them together, are "
                  "stretched to 8 bits.",
                  images.size(),
                  range->low,
                  range->high));
  return range;
}

}  // namespace hpm
