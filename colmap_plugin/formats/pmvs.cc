#include "colmap_plugin/formats/pmvs.h"

#include "colmap_plugin/formats/text_reader.h"
#include "src/base/error.h"

#include <fmt/format.h>

namespace hpm {
namespace {

// COLMAP's default number of sources.
constexpr int kMaxNumAuto = 20;

std::vector<int> ParseTimages(const LineReader& lines,
                              Words words,
                              int num_images) {
  const auto read_index = [&](int end) {
    const int index = ReadNumber<int>(lines, &words, "an image index");
    if (index < 0 || index >= end)
      lines.Fail(fmt::format("there is no image {}", index));
    return index;
  };
  std::vector<int> indices;
  const int count =
      ReadNumber<int>(lines, &words, "a number of images after timages");
  if (count == -1) {
    const int begin = read_index(num_images);
    const int end = read_index(num_images + 1);
    if (begin >= end) lines.Fail("the range of images is empty");
    for (int i = begin; i < end; ++i) indices.push_back(i);
  } else {
    if (count < 0) lines.Fail("expected a number of images after timages");
    for (int i = 0; i < count; ++i) indices.push_back(read_index(num_images));
  }
  if (!words.AtEnd()) lines.Fail("timages lists more images than it says");
  return indices;
}

}  // namespace

std::vector<int> ReadPmvsOptionFile(const std::filesystem::path& path,
                                    int num_images) {
  LineReader lines(path);
  std::optional<std::vector<int>> indices;
  while (lines.Next()) {
    Words words(lines.line());
    if (words.Next() == "timages")
      indices = ParseTimages(lines, words, num_images);
  }
  if (!indices) {
    throw Error(
        ErrorCode::kBadInput,
        fmt::format("{} has no line 'timages'; add one that lists the images",
                    path.string()));
  }
  return *indices;
}

std::vector<PatchMatchCfgEntry> MakePmvsCfgEntries(
    const PmvsModel& model, const std::vector<int>& image_indices) {
  std::vector<PatchMatchCfgEntry> entries;
  for (const int index : image_indices) {
    PatchMatchCfgEntry entry;
    entry.ref_name = model.sparse.images.at(static_cast<size_t>(index)).name;
    if (model.visible_images) {
      entry.sources = PatchMatchCfgEntry::Sources::kList;
      for (const int source :
           model.visible_images->at(static_cast<size_t>(index))) {
        entry.src_names.push_back(
            model.sparse.images.at(static_cast<size_t>(source)).name);
      }
    } else {
      entry.sources = PatchMatchCfgEntry::Sources::kAuto;
      entry.max_num_auto = kMaxNumAuto;
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace hpm
