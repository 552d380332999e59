#include "colmap_plugin/controller/unreadable_images.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "src/base/error.h"
#include "src/image/decode_picture.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <tbb/parallel_for.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

fs::path FolderOf(const Workspace& workspace) {
  return workspace.StatePath() / "unreadable_images";
}

std::vector<int> ImagesWithPicture(const Workspace& workspace) {
  std::vector<int> images;
  for (int i = 0; i < workspace.num_images(); ++i) {
    if (workspace.usable(i) && workspace.has_picture(i)) images.push_back(i);
  }
  return images;
}

}  // namespace

void RecordUnreadable(const Workspace& workspace,
                      const ImageContents& contents,
                      int image,
                      const std::string& why) {
  const std::string& hash = contents.HashOf(image);
  // Of a file that cannot be read at all, there is no hash.
  if (!hash.empty()) WriteFileAtomically(FolderOf(workspace) / hash, why);
}

std::vector<std::string> DropUnreadable(Workspace* workspace,
                                        ImageContents* contents,
                                        const CancelToken& cancel) {
  std::vector<std::string> lines;
  std::error_code error;
  if (!fs::exists(FolderOf(*workspace), error)) return lines;
  const std::vector<int> images = ImagesWithPicture(*workspace);
  contents->Read(images, cancel);
  for (const int image : images) {
    const std::string& hash = contents->HashOf(image);
    if (hash.empty()) continue;
    std::ifstream file(FolderOf(*workspace) / hash, std::ios::binary);
    if (!file) continue;
    lines.emplace_back(std::istreambuf_iterator<char>(file),
                       std::istreambuf_iterator<char>());
    workspace->DropPicture(image);
  }
  return lines;
}

std::vector<std::string> DropTruncated(Workspace* workspace,
                                       const CancelToken& cancel) {
  const std::vector<int> images = ImagesWithPicture(*workspace);
  std::vector<std::string> faults(images.size());
  tbb::parallel_for(size_t{0}, images.size(), [&](size_t i) {
    cancel.ThrowIfCancelled();
    try {
      ReadPictureFile(workspace->ImagePath(images[i]));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kBadInput) throw;
      faults[i] = error.what();
    }
  });
  std::vector<std::string> lines;
  for (size_t i = 0; i < images.size(); ++i) {
    if (faults[i].empty()) continue;
    lines.push_back(faults[i]);
    workspace->DropPicture(images[i]);
  }
  return lines;
}

}  // namespace hpm
