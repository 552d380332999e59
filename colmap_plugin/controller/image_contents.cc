#include "colmap_plugin/controller/image_contents.h"

#include "colmap_plugin/formats/content_hash.h"
#include "src/base/error.h"

#include <tbb/parallel_for.h>

namespace hpm {

ImageContents::ImageContents(const Workspace& workspace)
    : workspace_(&workspace), contents_(workspace.num_images()) {}

void ImageContents::Read(const std::vector<int>& images,
                         const CancelToken& cancel) {
  std::vector<int> unknown;
  for (const int image : images) {
    if (contents_[image].is_known || !workspace_->has_picture(image)) continue;
    contents_[image].is_known = true;
    unknown.push_back(image);
  }
  tbb::parallel_for(size_t{0}, unknown.size(), [&](size_t i) {
    Content* content = &contents_[unknown[i]];
    const auto& path = workspace_->ImagePath(unknown[i]);
    try {
      content->state = StateOf(path);
      content->hash = HashFile(path, cancel);
      const auto& mask = workspace_->MaskPath(unknown[i]);
      content->mask_state = StateOf(mask);
      if (!mask.empty()) content->hash += " mask " + HashFile(mask, cancel);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kBadInput) throw;
    }
  });
}

bool ImageContents::IsUnchanged(int image) const {
  const Content& content = contents_[image];
  return !content.hash.empty() && content.state &&
         StateOf(workspace_->ImagePath(image)) == content.state &&
         StateOf(workspace_->MaskPath(image)) == content.mask_state;
}

}  // namespace hpm
