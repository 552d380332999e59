#include "colmap_plugin/controller/unreadable_images.h"

#include "colmap_plugin/controller/run_budget.h"
#include "colmap_plugin/formats/atomic_file.h"
#include "src/base/input_file.h"
#include "src/image/decode_picture.h"
#include "src/image/load_image.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

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

// Decoded once more: what failed before may have been the disk or a limit of
// the moment, and good contents must not be given up for ever.
bool IsDamaged(const Workspace& workspace, int image) {
  const Camera& camera = workspace.camera(image);
  try {
    LoadGrayImage(workspace.ImagePath(image),
                  camera.width,
                  camera.height,
                  workspace.Decoding(image));
    return false;
  } catch (const UnreadableFile&) {
    return false;
  } catch (const Error&) {
    return true;
  }
}

}  // namespace

void RecordUnreadable(const Workspace& workspace,
                      const ImageContents& contents,
                      int image,
                      const std::string& why) {
  // Of a file that cannot be read at all, there is no hash.
  const std::string& hash = contents.HashOf(image);
  if (hash.empty() || !contents.IsUnchanged(image) ||
      !IsDamaged(workspace, image)) {
    return;
  }
  WriteFileAtomically(FolderOf(workspace) / hash, why);
}

void ForgetMended(const Workspace& workspace, const ImageContents& contents) {
  std::set<std::string> hashes;
  for (int i = 0; i < workspace.num_images(); ++i)
    hashes.insert(contents.HashOf(i));
  std::error_code error;
  std::vector<fs::path> mended;
  for (fs::directory_iterator it(FolderOf(workspace), error), end;
       !error && it != end;
       it.increment(error)) {
    if (hashes.count(it->path().filename().string()) == 0)
      mended.push_back(it->path());
  }
  for (const fs::path& path : mended) fs::remove(path, error);
  fs::remove(FolderOf(workspace), error);  // if it is empty
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
  const auto look = [&](size_t i) {
    cancel.ThrowIfCancelled();
    try {
      ReadPictureFile(workspace->ImagePath(images[i]));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kBadInput) throw;
      faults[i] = error.what();
    }
  };
  uint64_t largest = 0;  // held in memory by each thread
  for (const int image : images) {
    if (const auto& size = workspace->file_size(image))
      largest = std::max(largest, size->file_bytes);
  }
  tbb::task_arena(ThreadsToDecode(largest)).execute([&] {
    tbb::parallel_for(size_t{0}, images.size(), look);
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
