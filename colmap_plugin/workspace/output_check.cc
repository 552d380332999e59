#include "colmap_plugin/workspace/output_check.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "src/base/error.h"

#include <filesystem>
#include <set>
#include <string>

#include <fmt/format.h>
#include <sys/statvfs.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

// Creating a file is the only honest test: permission bits mean nothing to root
// and access() nothing on a read-only or full disk.
void CheckWritable(const fs::path& folder) {
  AtomicFile trial(folder / "write_test");
}

void CheckFreeSpace(const fs::path& folder, uint64_t num_bytes) {
  struct statvfs disk = {};
  // Some network file systems report no sizes; then the writes themselves must
  // tell.
  if (statvfs(folder.c_str(), &disk) != 0 || disk.f_blocks == 0) return;
  const uint64_t num_free = static_cast<uint64_t>(disk.f_bavail) *
                            static_cast<uint64_t>(disk.f_frsize);
  if (num_free >= num_bytes) return;
  throw Error(
      ErrorCode::kOutOfResources,
      fmt::format(
          "{}: the maps need {} bytes, {} bytes are free; make room, lower "
          "--PatchMatchStereo.max_image_size or list fewer images",
          folder.string(),
          num_bytes,
          num_free));
}

}  // namespace

uint64_t DepthAndNormalMapBytes(const Camera& camera) {
  const auto header_bytes = [&](int channels) {
    return fmt::format("{}&{}&{}&", camera.width, camera.height, channels)
        .size();
  };
  const uint64_t num_pixels = static_cast<uint64_t>(camera.width) *
                              static_cast<uint64_t>(camera.height);
  return header_bytes(1) + header_bytes(3) + 4 * sizeof(float) * num_pixels;
}

void PrepareOutputs(const Workspace& workspace,
                    const std::vector<StereoProblem>& problems,
                    uint64_t num_bytes) {
  std::set<fs::path> folders = {workspace.StatePath()};
  for (const StereoProblem& problem : problems) {
    if (!problem.is_reference) continue;
    for (const MapKind kind :
         {MapKind::kDepth, MapKind::kNormal, MapKind::kConsistencyGraph}) {
      folders.insert(workspace.MapPath(problem.ref_image, kind, "photometric")
                         .parent_path());
    }
  }
  for (const fs::path& folder : folders) CheckWritable(folder);
  CheckFreeSpace(*folders.begin(), num_bytes);

  std::error_code error;
  if (!fs::exists(workspace.FusionCfgPath(), error)) {
    std::vector<std::string> names;
    for (const StereoProblem& problem : problems) {
      if (problem.is_reference)
        names.push_back(workspace.ImageName(problem.ref_image));
    }
    WriteFusionCfg(workspace.FusionCfgPath(), names);
  }
}

}  // namespace hpm
