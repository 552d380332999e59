#include "colmap_plugin/workspace/output_check.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/formats/text_reader.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/base/platform/files.h"
#include "src/base/retries.h"

#include <filesystem>
#include <set>
#include <string>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

// The folder, or the first one above it that exists.
fs::path FolderOnDisk(fs::path folder) {
  while (!Exists(folder) && folder != folder.parent_path())
    folder = folder.parent_path();
  return folder;
}

// Creating a file is the only honest test: not every file system that refuses
// says so in its permissions.
void CheckWritable(const fs::path& folder, OutputAccess access) {
  if (access == OutputAccess::kTry) {
    AtomicFile trial(folder / "write_test");
    return;
  }
  const fs::path on_disk = FolderOnDisk(folder);
  if (IsFolder(on_disk) && MayWriteInto(on_disk)) return;
  throw Error(ErrorCode::kBadInput,
              fmt::format("cannot write into {}: {}; make {} a writable folder",
                          folder.string(),
                          IsFolder(on_disk) ? "no permission" : "not a folder",
                          on_disk.string()));
}

void CheckFreeSpace(const fs::path& folder, uint64_t num_bytes) {
  // Where nothing tells, the writes themselves must.
  const std::optional<uint64_t> num_free = FreeBytes(folder);
  if (!num_free || *num_free >= num_bytes) return;
  throw Error(
      ErrorCode::kOutOfResources,
      fmt::format(
          "{}: the maps need {} bytes, {} bytes are free; make room, lower "
          "--PatchMatchStereo.max_image_size or list fewer images",
          folder.string(),
          num_bytes,
          *num_free));
}

// Asks the file system itself: what it allows differs from one to another.
bool IsTooLong(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() == fs::file_type::none &&
         error == std::errc::filename_too_long;
}

void CheckNameFits(const fs::path& path, const std::string& image_name) {
  // Below a folder that does not exist no name is looked at.
  if (!IsTooLong(path) &&
      !IsTooLong(FolderOnDisk(path.parent_path()) / path.filename())) {
    return;
  }
  throw Error(ErrorCode::kBadInput,
              fmt::format("the image name {} is too long: {} would have {} "
                          "bytes, more than this disk allows for the name of a "
                          "file or for a path; shorten it in the sparse model "
                          "and rename the image file",
                          QuotedName(image_name),
                          QuotedName(path.filename().string()),
                          path.filename().string().size()));
}

// stereo_fusion gives up at the first name that the sparse model lacks.
void CheckFusionCfg(const Workspace& workspace, const LogSink& log) {
  const fs::path path = workspace.FusionCfgPath();
  std::string example;
  int num_names = 0, num_unknown = 0;
  for (LineReader lines(path); lines.Next();) {
    const std::string name(lines.line());
    if (name.empty()) continue;
    ++num_names;
    const int image = workspace.ImageIndex(name);
    if (image >= 0 && workspace.ImageName(image) == name) continue;
    if (num_unknown++ == 0)
      example = fmt::format("line {}, {}", lines.place(), QuotedName(name));
  }
  constexpr const char* kRemedy =
      "delete it and give this command again, which writes it anew";
  if (num_names == 0) {
    log(LogLevel::kWarning,
        fmt::format("{} names no image, so stereo_fusion will fuse nothing; {}",
                    path.string(),
                    kRemedy));
  } else if (num_unknown > 0) {
    log(LogLevel::kWarning,
        fmt::format("{} names {} images that the sparse model does not have "
                    "(the first: {}), so stereo_fusion will stop; {}",
                    path.string(),
                    num_unknown,
                    example,
                    kRemedy));
  }
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

std::optional<uint64_t> FreeBytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info disk = fs::space(FolderOnDisk(folder), error);
  // Some network file systems report no sizes.
  if (error || disk.capacity == 0) return std::nullopt;
  return disk.available;
}

void CheckOutputs(const Workspace& workspace,
                  const std::vector<StereoProblem>& problems,
                  uint64_t num_bytes,
                  OutputAccess access) {
  std::set<fs::path> folders = {workspace.StatePath()};
  for (const StereoProblem& problem : problems) {
    if (!problem.is_reference) continue;
    for (const MapKind kind :
         {MapKind::kDepth, MapKind::kNormal, MapKind::kConsistencyGraph}) {
      folders.insert(workspace.MapPath(problem.ref_image, kind, "photometric")
                         .parent_path());
    }
    const fs::path confidence =
        workspace
            .MapPath(problem.ref_image, MapKind::kConfidence, "photometric")
            .parent_path();
    // Made where it is asked for.
    if (Exists(confidence)) folders.insert(confidence);
  }
  for (const fs::path& folder : folders) CheckWritable(folder, access);
  for (const StereoProblem& problem : problems) {
    const std::string& name = workspace.ImageName(problem.ref_image);
    // The longest of the names an image's files get.
    CheckNameFits(
        workspace.MapPath(problem.ref_image, MapKind::kNormal, "photometric"),
        name);
    CheckNameFits(StampPath(workspace.StatePath(), name, "photometric"), name);
  }
  CheckFreeSpace(*folders.begin(), num_bytes);
}

void PrepareOutputs(const Workspace& workspace,
                    const std::vector<StereoProblem>& problems,
                    uint64_t num_bytes,
                    const LogSink& log) {
  CheckOutputs(workspace, problems, num_bytes, OutputAccess::kTry);
  if (!Exists(workspace.FusionCfgPath())) {
    std::vector<std::string> names;
    for (const StereoProblem& problem : problems) {
      if (problem.is_reference)
        names.push_back(workspace.ImageName(problem.ref_image));
    }
    WriteFusionCfg(workspace.FusionCfgPath(), names);
  } else if (log) {
    CheckFusionCfg(workspace, log);
  }
}

}  // namespace hpm
