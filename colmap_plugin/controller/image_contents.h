// What the files of the images and their masks contain, as a hash: maps must
// never be kept when an image or mask became another, whatever its size and
// time say.
#pragma once

#include "colmap_plugin/formats/published_file.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

#include <optional>
#include <string>
#include <vector>

namespace hpm {

class ImageContents {
 public:
  // Reads nothing yet. Keeps a reference to the workspace.
  explicit ImageContents(const Workspace& workspace);

  // Hashes those of the images with a picture that it has not hashed before, in
  // parallel. A file that cannot be read is left to decoding, which names it.
  // Throws Error(kInterrupted).
  void Read(const std::vector<int>& images, const CancelToken& cancel);

  // Empty if it was not read, or could not be.
  const std::string& HashOf(int image) const { return contents_[image].hash; }

  // Whether the file was read, and seems the same as then.
  bool IsUnchanged(int image) const;

 private:
  struct Content {
    bool is_known = false;
    std::string hash;
    std::optional<FileState> state;  // before it was read
    std::optional<FileState> mask_state;
  };

  const Workspace* workspace_;
  std::vector<Content> contents_;
};

}  // namespace hpm
