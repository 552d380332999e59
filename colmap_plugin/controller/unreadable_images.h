// Images that decoding found damaged, by their contents:
// stereo/hpm_mvs/unreadable_images/<hash>. Whoever plans afterwards knows it
// from the start, so that all shards of a run, the next run, and what is said
// about them plan the same.
#pragma once

#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

#include <string>
#include <vector>

namespace hpm {

// Of an image that is damaged now, not one that could only not be read then.
// why: one line for people.
void RecordUnreadable(const Workspace& workspace,
                      const ImageContents& contents,
                      int image,
                      const std::string& why);

// Marks images with such contents as without picture and returns what is wrong
// with them, one line each. Reads all images if there is any record. Throws
// Error(kInterrupted).
std::vector<std::string> DropUnreadable(Workspace* workspace,
                                        ImageContents* contents,
                                        const CancelToken& cancel);

// Removes the records of contents that no image has any more. After
// DropUnreadable(), and where nobody else works on the workspace.
void ForgetMended(const Workspace& workspace, const ImageContents& contents);

// The same as DropUnreadable() for images whose file ends too early (see
// src/image/image_integrity.h), which nobody has decoded yet. Reads all images.
std::vector<std::string> DropTruncated(Workspace* workspace,
                                       const CancelToken& cancel);

}  // namespace hpm
