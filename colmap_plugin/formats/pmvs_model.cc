// The two sources of a PMVS model: bundle.rd.out, or projection matrices with
// vis.dat.
#include "colmap_plugin/formats/pmvs.h"
#include "colmap_plugin/formats/text_reader.h"
#include "src/base/error.h"
#include "src/base/retries.h"

#include <limits>

#include <Eigen/LU>
#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

// Words of a file whose line breaks mean nothing.
class WordReader {
 public:
  explicit WordReader(const fs::path& path) : lines_(path), words_("") {}

  void SkipLine() { lines_.Next(); }

  std::string_view Next() {
    while (words_.AtEnd()) {
      if (!lines_.Next()) lines_.Fail("the file ends too early");
      words_ = Words(lines_.line());
    }
    return words_.Next();
  }

  template <class T>
  T Read(const char* what) {
    T value;
    if (!ParseNumber(Next(), &value)) Fail(fmt::format("expected {}", what));
    return value;
  }

  int ReadInRange(int begin, int end, const char* what) {
    const int value = Read<int>(what);
    if (value < begin || value >= end)
      Fail(fmt::format("{} {} is out of range", what, value));
    return value;
  }

  int ReadCount(const char* what) {
    return ReadInRange(0, std::numeric_limits<int>::max(), what);
  }

  [[noreturn]] void Fail(const std::string& what) const { lines_.Fail(what); }

 private:
  LineReader lines_;
  Words words_;
};

std::string ImageName(int index) { return fmt::format("{:08d}.jpg", index); }

Eigen::Quaterniond RotationOrNan(const Eigen::Matrix3d& matrix) {
  // Text files carry few digits; a matrix further off is no rotation at all.
  constexpr double kTolerance = 1e-3;
  const bool is_rotation =
      matrix.allFinite() &&
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm() <
          kTolerance &&
      matrix.determinant() > 0;
  if (is_rotation) return Eigen::Quaterniond(matrix).normalized();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return Eigen::Quaterniond(nan, nan, nan, nan);
}

void AddImage(const std::pair<int, int>& size,
              const Eigen::Vector4d& intrinsics,  // fx, fy, cx, cy
              const Eigen::Matrix3d& rotation,
              const Eigen::Vector3d& translation,
              SparseModel* model) {
  const int index = static_cast<int>(model->images.size());
  SparseCamera camera;
  camera.model = "PINHOLE";
  camera.width = static_cast<uint64_t>(size.first);
  camera.height = static_cast<uint64_t>(size.second);
  camera.params.assign(intrinsics.data(), intrinsics.data() + 4);
  SparseImage image;
  image.id = static_cast<uint32_t>(index);
  image.name = ImageName(index);
  image.camera_id = image.id;
  image.cam_from_world_rotation = RotationOrNan(rotation);
  image.cam_from_world_translation = translation;
  model->cameras.emplace(image.id, std::move(camera));
  model->images.push_back(std::move(image));
}

std::pair<int, int> CheckedImageSize(const fs::path& path,
                                     const ImageSizeReader& image_size) {
  const std::pair<int, int> size = image_size(path);
  if (size.first <= 0 || size.second <= 0) {
    throw Error(
        ErrorCode::kBadInput,
        fmt::format("{} has no pixels; write the image again", path.string()));
  }
  return size;
}

// Bundler's camera looks along -z with y up; ours looks along z with y down.
SparseModel ReadBundle(const fs::path& folder,
                       const ImageSizeReader& image_size) {
  WordReader words(folder / "bundle.rd.out");
  words.SkipLine();  // "# Bundle file v0.3"
  const int num_images = words.ReadCount("the number of images");
  const int num_points = words.ReadCount("the number of points");
  SparseModel model;
  for (int i = 0; i < num_images; ++i) {
    const double focal = words.Read<double>("a focal length");
    for (int k = 0; k < 2; ++k) {
      if (words.Read<double>("a distortion") != 0) {
        words.Fail(fmt::format("image {} is distorted; undistort it first", i));
      }
    }
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    for (int k = 0; k < 9; ++k)
      rotation(k / 3, k % 3) = words.Read<double>("a rotation");
    for (int k = 0; k < 3; ++k)
      translation[k] = words.Read<double>("a translation");
    rotation.bottomRows<2>() *= -1;
    translation.tail<2>() *= -1;
    const std::pair<int, int> size =
        CheckedImageSize(folder / "visualize" / ImageName(i), image_size);
    AddImage(size,
             Eigen::Vector4d(focal, focal, size.first / 2.0, size.second / 2.0),
             rotation,
             translation,
             &model);
  }
  std::vector<int> track;
  for (int i = 0; i < num_points; ++i) {
    Eigen::Vector3d xyz;
    for (int k = 0; k < 3; ++k) xyz[k] = words.Read<double>("a coordinate");
    for (int k = 0; k < 3; ++k) words.Read<double>("a colour");
    const int track_length = words.ReadCount("a track length");
    track.clear();
    for (int k = 0; k < track_length; ++k) {
      track.push_back(words.ReadInRange(0, num_images, "the image index"));
      for (int skipped = 0; skipped < 3; ++skipped)
        words.Read<double>("a feature");
    }
    if (xyz.allFinite()) model.points.Add(xyz, track);
  }
  return model;
}

// RQ decomposition by Gram-Schmidt from the last row up: P = K [R | t] up to
// scale, K upper triangular with positive diagonal, det(R) = 1.
void AddProjection(const std::pair<int, int>& size,
                   Eigen::Matrix<double, 3, 4> projection,
                   SparseModel* model) {
  if (projection.leftCols<3>().determinant() < 0) projection *= -1;
  Eigen::Matrix3d rotation = projection.leftCols<3>();
  Eigen::Matrix3d calibration = Eigen::Matrix3d::Zero();
  for (int i = 2; i >= 0; --i) {
    for (int j = 2; j > i; --j) {
      calibration(i, j) = rotation.row(i).dot(rotation.row(j));
      rotation.row(i) -= calibration(i, j) * rotation.row(j);
    }
    calibration(i, i) = rotation.row(i).norm();
    rotation.row(i) /= calibration(i, i);
  }
  const Eigen::Vector3d translation =
      calibration.triangularView<Eigen::Upper>().solve(projection.col(3));
  calibration /= calibration(2, 2);
  AddImage(size,
           Eigen::Vector4d(calibration(0, 0),
                           calibration(1, 1),
                           calibration(0, 2),
                           calibration(1, 2)),
           rotation,
           translation,
           model);
}

SparseModel ReadProjections(const fs::path& folder,
                            const ImageSizeReader& image_size) {
  SparseModel model;
  for (int i = 0;; ++i) {
    const fs::path image_path = folder / "visualize" / ImageName(i);
    if (!Exists(image_path)) return model;
    WordReader words(folder / "txt" / fmt::format("{:08d}.txt", i));
    if (words.Next() != "CONTOUR") words.Fail("expected CONTOUR");
    Eigen::Matrix<double, 3, 4> projection;
    for (int k = 0; k < 12; ++k) {
      projection(k / 4, k % 4) =
          words.Read<double>("an entry of the projection matrix");
    }
    AddProjection(CheckedImageSize(image_path, image_size), projection, &model);
  }
}

std::vector<std::vector<int>> ReadVisDat(const fs::path& path, int num_images) {
  WordReader words(path);
  if (words.Next() != "VISDATA") words.Fail("expected VISDATA");
  if (words.ReadCount("the number of images") != num_images) {
    words.Fail(fmt::format("expected {} images, as many as visualize/ holds",
                           num_images));
  }
  std::vector<std::vector<int>> visible(static_cast<size_t>(num_images));
  for (int i = 0; i < num_images; ++i) {
    const int image = words.ReadInRange(0, num_images, "the image index");
    const int count = words.ReadCount("a number of images");
    for (int k = 0; k < count; ++k) {
      const int other = words.ReadInRange(0, num_images, "the image index");
      if (other != image) visible[static_cast<size_t>(image)].push_back(other);
    }
  }
  return visible;
}

}  // namespace

PmvsModel ReadPmvsModel(const fs::path& folder,
                        const ImageSizeReader& image_size) {
  PmvsModel model;
  if (Exists(folder / "bundle.rd.out")) {
    model.sparse = ReadBundle(folder, image_size);
  } else if (Exists(folder / "vis.dat")) {
    model.sparse = ReadProjections(folder, image_size);
    model.visible_images = ReadVisDat(
        folder / "vis.dat", static_cast<int>(model.sparse.images.size()));
  } else {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{} holds neither bundle.rd.out nor vis.dat; give "
                            "the folder 'pmvs' "
                            "that image_undistorter wrote",
                            folder.string()));
  }
  return model;
}

}  // namespace hpm
