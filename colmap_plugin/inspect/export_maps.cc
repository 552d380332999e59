#include "colmap_plugin/inspect/export_maps.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/exchange_files.h"
#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/inspect/map_faults.h"
#include "src/base/error.h"
#include "src/base/input_file.h"
#include "src/base/retries.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hpm {
namespace fs = std::filesystem;
namespace {

constexpr double kMostSteps = 65535;

// COLMAP's camera at the size of the maps: the ray of column c and row r goes
// through ((c - cx) / fx, (r - cy) / fy, 1), as fusion takes it.
struct MapCamera {
  double fx, fy, cx, cy;
};

MapCamera CameraOf(const Workspace& workspace, int image, const Map& depth) {
  const Camera& camera = workspace.camera(image);
  const double x = static_cast<double>(depth.width) / camera.width;
  const double y = static_cast<double>(depth.height) / camera.height;
  return {camera.fx * x,
          camera.fy * y,
          (camera.cx + 0.5) * x,
          (camera.cy + 0.5) * y};
}

std::string EncodePng(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

// 0 is no depth, and no depth becomes 0.
std::string DepthAsPng(const Map& depth, double step) {
  cv::Mat image(depth.height, depth.width, CV_16U);
  for (size_t i = 0; i < depth.data.size(); ++i) {
    const double steps = std::round(depth.data[i] / step);
    image.ptr<uint16_t>()[i] =
        depth.data[i] > 0
            ? static_cast<uint16_t>(std::clamp(steps, 1.0, kMostSteps))
            : 0;
  }
  return EncodePng(image);
}

// -1 ... 1 becomes 1 ... 65535, red is x; black where there is none.
std::string NormalAsPng(const Map& normal) {
  cv::Mat image(normal.height, normal.width, CV_16UC3, cv::Scalar::all(0));
  const size_t size = normal.data.size() / 3;
  for (size_t i = 0; i < size; ++i) {
    const float* at = &normal.data[i];
    if (at[0] == 0 && at[size] == 0 && at[2 * size] == 0) continue;
    uint16_t* to = image.ptr<uint16_t>() + 3 * i;
    for (int axis = 0; axis < 3; ++axis) {
      to[2 - axis] = cv::saturate_cast<uint16_t>(
          32768 + 32767 * std::clamp(at[axis * size], -1.0f, 1.0f));
    }
  }
  return EncodePng(image);
}

std::string ConfidenceAsPng(const Map& confidence) {
  cv::Mat image(confidence.height, confidence.width, CV_16U);
  for (size_t i = 0; i < confidence.data.size(); ++i) {
    image.ptr<uint16_t>()[i] = cv::saturate_cast<uint16_t>(
        kMostSteps * static_cast<double>(confidence.data[i]));
  }
  return EncodePng(image);
}

std::string Encode(const Map& map, const std::string& format) {
  if (format == "exr") return EncodeExr(map);
  if (format == "pfm") return EncodePfm(map);
  return EncodeNpy(map);
}

cv::Mat ColorsOf(const Workspace& workspace, int image, const Map& depth) {
  cv::Mat color;
  try {
    color = cv::imread(workspace.ImagePath(image).string(),
                       cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    color.release();
  }
  if (color.empty())
    return {depth.height, depth.width, CV_8UC3, cv::Scalar::all(128)};
  cv::Mat resized;
  cv::resize(color, resized, {depth.width, depth.height}, 0, 0, cv::INTER_AREA);
  return resized;
}

std::string CloudOf(const Workspace& workspace,
                    int image,
                    const Map& depth,
                    const Map& normal) {
  const MapCamera camera = CameraOf(workspace, image, depth);
  const Eigen::Matrix3d world_from_cam =
      workspace.model()
          .images[image]
          .cam_from_world_rotation.conjugate()
          .toRotationMatrix();
  const cv::Mat color = ColorsOf(workspace, image, depth);
  const size_t size = depth.data.size();
  std::vector<CloudPoint> points;
  for (int row = 0; row < depth.height; ++row) {
    for (int col = 0; col < depth.width; ++col) {
      const size_t i = static_cast<size_t>(row) * depth.width + col;
      const double z = depth.data[i];
      if (!(z > 0)) continue;
      const Eigen::Vector3d in_camera((col - camera.cx) / camera.fx * z,
                                      (row - camera.cy) / camera.fy * z,
                                      z);
      const Eigen::Vector3d at =
          workspace.Center(image) + world_from_cam * in_camera;
      const Eigen::Vector3f n =
          (world_from_cam * Eigen::Vector3d(normal.data[i],
                                            normal.data[size + i],
                                            normal.data[2 * size + i]))
              .cast<float>();
      const auto& bgr = color.at<cv::Vec3b>(row, col);
      points.push_back({{at.x(), at.y(), at.z()},
                        {n.x(), n.y(), n.z()},
                        {bgr[2], bgr[1], bgr[0]}});
    }
  }
  return EncodePly(points);
}

// What the numbers mean and which camera they belong to.
nlohmann::json Description(const Workspace& workspace,
                           int image,
                           const Map& depth,
                           const ExportOptions& options,
                           double step) {
  const MapCamera camera = CameraOf(workspace, image, depth);
  const auto& pose = workspace.model().images[image];
  const Eigen::Quaterniond& q = pose.cam_from_world_rotation;
  const Eigen::Vector3d& t = pose.cam_from_world_translation;
  nlohmann::json json = {
      {"image", workspace.ImageName(image)},
      {"input_type", options.input_type},
      {"width", depth.width},
      {"height", depth.height},
      {"depth", "z in the camera's frame in model units, 0 = none"},
      {"normal", "unit, in the camera's frame, toward the camera, 0 = none"},
      {"ray", "((col - cx) / fx, (row - cy) / fy, 1)"},
      {"fx", camera.fx},
      {"fy", camera.fy},
      {"cx", camera.cx},
      {"cy", camera.cy},
      {"cam_from_world_rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
      {"cam_from_world_translation", {t.x(), t.y(), t.z()}}};
  if (step > 0) {
    json["depth_per_step"] = step;
    json["normal_from_value"] = "(value - 32768) / 32767, 0 0 0 = none";
  }
  return json;
}

// How the PNGs of an earlier export, which still lie beside, are to be read.
void KeepStepsOfPngs(const fs::path& folder,
                     const std::string& name,
                     nlohmann::json* description) {
  constexpr uint64_t kMostBytes = 1 << 20;
  nlohmann::json old;
  try {
    const fs::path path = folder / (name + ".json");
    if (!Exists(path)) return;
    old = nlohmann::json::parse(
        ReadWholeFile(path, kMostBytes), nullptr, /*allow_exceptions=*/false);
  } catch (const Error&) {
    return;  // it is replaced
  }
  if (!old.is_object()) return;
  const std::pair<const char*, const char*> kept[] = {
      {"depth_per_step", ".depth.png"},
      {"normal_from_value", ".normal.png"},
      {"confidence_per_step", ".confidence.png"}};
  for (const auto& [key, end] : kept) {
    if (old.contains(key) && !description->contains(key) &&
        Exists(folder / (name + end)))
      (*description)[key] = old[key];
  }
}

[[noreturn]] void ThrowUnfit(const fs::path& path) {
  throw Error(ErrorCode::kBadInput,
              path.string() +
                  ": the maps of this image do not fit together; hpm_mvs check "
                  "--fix 1 and another run make them anew");
}

// Numbers that no map may hold would go on into other programs.
void ThrowIfFaulty(const fs::path& path, const std::string& fault) {
  if (fault.empty()) return;
  throw Error(ErrorCode::kBadInput,
              path.string() + ": " + fault +
                  "; hpm_mvs check --fix 1 and another run make it anew");
}

void CheckPair(const Map& depth, const Map& normal, const fs::path& path) {
  if (depth.channels == 1 && normal.channels == 3 &&
      depth.width == normal.width && depth.height == normal.height) {
    return;
  }
  ThrowUnfit(path);
}

void ExportImage(const Workspace& workspace,
                 int image,
                 const ExportOptions& options,
                 const fs::path& folder) {
  const fs::path depth_path =
      workspace.MapPath(image, MapKind::kDepth, options.input_type);
  const fs::path normal_path =
      workspace.MapPath(image, MapKind::kNormal, options.input_type);
  ThrowIfFaulty(depth_path, FaultOfDepths(depth_path, kAnyDepth));
  ThrowIfFaulty(normal_path, FaultOfNormals(normal_path));
  const fs::path confidence_path =
      workspace.MapPath(image, MapKind::kConfidence, options.input_type);
  if (Exists(confidence_path))
    ThrowIfFaulty(confidence_path, FaultOfConfidence(confidence_path));
  const Map depth = ReadMap(depth_path);
  const Map normal = ReadMap(normal_path);
  CheckPair(depth, normal, depth_path);
  const std::string& name = workspace.ImageName(image);
  if (options.format == "ply") {
    WriteFileAtomically(folder / (name + ".ply"),
                        CloudOf(workspace, image, depth, normal));
    return;
  }
  double step = 0;
  if (options.format == "png16") {
    const float largest =
        *std::max_element(depth.data.begin(), depth.data.end());
    step = options.depth_step > 0 ? options.depth_step : largest / kMostSteps;
    if (!(step > 0)) step = 1;  // no depth at all
    if (largest > step * (kMostSteps + 0.5)) {
      throw Error(
          ErrorCode::kBadInput,
          fmt::format("--depth_step {}: {} has depths up to {:.6g}, beyond the "
                      "{} steps of 16 bits; give at least {:.6g}, or 0",
                      options.depth_step,
                      QuotedName(name),
                      largest,
                      kMostSteps,
                      largest / kMostSteps));
    }
    WriteFileAtomically(folder / (name + ".depth.png"),
                        DepthAsPng(depth, step));
    WriteFileAtomically(folder / (name + ".normal.png"), NormalAsPng(normal));
  } else {
    const std::string end = "." + options.format;
    WriteFileAtomically(folder / (name + ".depth" + end),
                        Encode(depth, options.format));
    WriteFileAtomically(folder / (name + ".normal" + end),
                        Encode(normal, options.format));
  }
  nlohmann::json description =
      Description(workspace, image, depth, options, step);
  if (Exists(confidence_path)) {
    const Map confidence = ReadMap(confidence_path);
    if (confidence.channels != 1 || confidence.width != depth.width ||
        confidence.height != depth.height)
      ThrowUnfit(confidence_path);
    description["confidence"] =
        "probability that the depth is within 1 % of the truth";
    if (options.format == "png16")
      description["confidence_per_step"] = 1 / kMostSteps;
    WriteFileAtomically(
        folder / (name + ".confidence." +
                  (options.format == "png16" ? "png" : options.format)),
        options.format == "png16" ? ConfidenceAsPng(confidence)
                                  : Encode(confidence, options.format));
  }
  KeepStepsOfPngs(folder, name, &description);
  WriteFileAtomically(
      folder / (name + ".json"),
      description.dump(
          2, ' ', false, nlohmann::json::error_handler_t::replace) +
          "\n");
}

}  // namespace

ExportResult ExportMaps(const WorkspaceOptions& workspace_options,
                        const ExportOptions& options,
                        const LogSink& log,
                        const CancelToken& cancel) {
  const Workspace workspace(workspace_options, log);
  std::vector<int> images;
  for (int image = 0; image < workspace.num_images(); ++image) {
    std::error_code ignored;
    if (workspace.usable(image) &&
        fs::exists(
            workspace.MapPath(image, MapKind::kDepth, options.input_type),
            ignored)) {
      images.push_back(image);
    }
  }
  if (!options.image_name.empty()) {
    const int image = workspace.ImageIndex(options.image_name);
    if (image < 0) {
      throw Error(ErrorCode::kBadInput,
                  fmt::format("--image_name {}: the sparse model has no such "
                              "image; give a name as in images/",
                              QuotedName(options.image_name)));
    }
    const bool has_maps =
        std::find(images.begin(), images.end(), image) != images.end();
    images.assign(has_maps ? 1 : 0, image);
  }
  if (images.empty()) {
    throw Error(
        ErrorCode::kBadInput,
        fmt::format("{}: {} no {} maps; run hpm_mvs patch_match_stereo first, "
                    "or give the other --input_type",
                    (workspace.StereoPath() / "depth_maps").string(),
                    options.image_name.empty()
                        ? "there are"
                        : QuotedName(options.image_name) + " has",
                    options.input_type));
  }
  ExportResult result;
  result.folder = options.output_path;
  if (result.folder.empty()) {
    // Files of both kinds have the same names.
    result.folder =
        workspace.StereoPath() / (options.input_type == "geometric"
                                      ? "export"
                                      : "export_" + options.input_type);
  }
  for (const int image : images) {
    cancel.ThrowIfCancelled();
    try {
      ExportImage(workspace, image, options, result.folder);
      ++result.num_images;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kBadInput) throw;
      result.failed.push_back(error.what());
    }
  }
  return result;
}

}  // namespace hpm
