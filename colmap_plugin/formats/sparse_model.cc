#include "colmap_plugin/formats/sparse_model.h"

#include "colmap_plugin/formats/frame_poses.h"
#include "colmap_plugin/formats/sparse_model_io.h"
#include "src/base/error.h"
#include "src/base/retries.h"

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

using FileReader = void (*)(const fs::path&, SparseModelBuilder*);

struct Encoding {
  const char* extension;
  FileReader read_cameras;
  FileReader read_images;
  FileReader read_rigs;
  FileReader read_frames;
  FileReader read_points;
};

constexpr Encoding kBinary = {".bin",
                              ReadCamerasBinary,
                              ReadImagesBinary,
                              ReadRigsBinary,
                              ReadFramesBinary,
                              ReadPointsBinary};
constexpr Encoding kText = {".txt",
                            ReadCamerasText,
                            ReadImagesText,
                            ReadRigsText,
                            ReadFramesText,
                            ReadPointsText};

fs::path FilePath(const fs::path& folder,
                  const char* stem,
                  const Encoding& encoding) {
  return folder / (std::string(stem) + encoding.extension);
}

bool IsComplete(const fs::path& folder, const Encoding& encoding) {
  for (const char* stem : {"cameras", "images", "points3D"}) {
    if (!Exists(FilePath(folder, stem, encoding))) return false;
  }
  return true;
}

SparseModel Read(const fs::path& folder,
                 const Encoding& encoding,
                 const LogSink& log,
                 const CancelToken& cancel) {
  SparseModelBuilder builder(&cancel);
  encoding.read_cameras(FilePath(folder, "cameras", encoding), &builder);
  encoding.read_images(FilePath(folder, "images", encoding), &builder);
  const fs::path rigs = FilePath(folder, "rigs", encoding);
  const fs::path frames = FilePath(folder, "frames", encoding);
  if (Exists(rigs) != Exists(frames)) {
    throw Error(
        ErrorCode::kBadInput,
        fmt::format("{} exists without {}; export the model again or delete it",
                    (Exists(rigs) ? rigs : frames).string(),
                    (Exists(rigs) ? frames : rigs).filename().string()));
  }
  if (Exists(rigs)) {
    encoding.read_rigs(rigs, &builder);
    encoding.read_frames(frames, &builder);
    if (log && !builder.replaced_poses().empty()) {
      const std::string stale = DescribeStalePoses(
          builder.model().images, builder.replaced_poses(), encoding.extension);
      if (!stale.empty()) log(LogLevel::kWarning, stale);
    }
  }
  encoding.read_points(FilePath(folder, "points3D", encoding), &builder);
  return builder.Release();
}

}  // namespace

SparseModel ReadSparseModel(const fs::path& folder,
                            const LogSink& log,
                            const CancelToken& cancel) {
  for (const Encoding* encoding : {&kBinary, &kText}) {
    if (IsComplete(folder, *encoding))
      return Read(folder, *encoding, log, cancel);
  }
  std::error_code error;
  if (!fs::exists(folder / "cameras.bin", error) && error) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("cannot look into {}: {}; make the folder readable "
                            "and searchable",
                            folder.string(),
                            error.message()));
  }
  // The mapper numbers its models; a dense workspace has one, without number.
  const fs::path numbered = folder / "0";
  std::string remedy = "run image_undistorter first";
  if (IsComplete(numbered, kBinary) || IsComplete(numbered, kText)) {
    remedy = fmt::format(
        "{} holds one: if its cameras are those of the undistorted images, "
        "move its files one folder up, where stereo_fusion looks for them too",
        numbered.string());
  }
  throw Error(ErrorCode::kBadInput,
              fmt::format("{} holds no complete sparse model (cameras, images "
                          "and points3D, all .bin or all .txt); {}",
                          folder.string(),
                          remedy));
}

}  // namespace hpm
