#include "colmap_plugin/formats/pmvs.h"

#include "tests/colmap_plugin/formats/test_files.h"

#include <Eigen/LU>

namespace hpm {
namespace {

using testing::ElementsAre;

std::pair<int, int> FixedSize(const std::filesystem::path&) {
  return {161, 120};
}

class Pmvs : public testing::Test {
 protected:
  PmvsModel Read() { return ReadPmvsModel(folder_.path(), FixedSize); }

  void WriteImagePlaceholders(int num_images) {
    for (int i = 0; i < num_images; ++i) {
      WriteFile(folder_ / ("visualize/0000000" + std::to_string(i) + ".jpg"),
                "");
    }
  }

  // P = scale * K [R | t]
  void WriteProjection(int index, const Eigen::Matrix<double, 3, 4>& matrix) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(17);
    text << "CONTOUR\n" << matrix << "\n";
    WriteFile(folder_ / ("txt/0000000" + std::to_string(index) + ".txt"),
              text.str());
  }

  ScratchFolder folder_;
};

const char* const kBundle =
    "# Bundle file v0.3\n2 1\n"
    "150 0 0\n1 0 0\n0 1 0\n0 0 1\n1 2 3\n"
    "151.5 0 0\n0 -1 0\n1 0 0\n0 0 1\n0 0 0\n"
    "1 2 -5\n10 20 30\n3 1 7 0.5 0.5 0 8 1 1 1 9 2 2\n";

TEST_F(Pmvs, BundleTurnsFromBundlersAxesToOurs) {
  const CommaLocale locale;
  WriteFile(folder_ / "bundle.rd.out", kBundle);
  const PmvsModel model = Read();
  EXPECT_FALSE(model.visible_images);
  ASSERT_EQ(model.sparse.images.size(), 2u);
  const SparseImage& image = model.sparse.images[1];
  EXPECT_EQ(image.name, "00000001.jpg");
  const SparseCamera& camera = model.sparse.cameras.at(image.camera_id);
  EXPECT_EQ(camera.model, "PINHOLE");
  EXPECT_EQ(camera.width, 161u);
  EXPECT_THAT(camera.params, ElementsAre(151.5, 151.5, 80.5, 60));

  // Bundler's camera point (x, y, z) is our (x, -y, -z).
  const Eigen::Vector3d world(0.3, -0.7, 2);
  const Eigen::Vector3d ours =
      model.sparse.images[0].cam_from_world_rotation * world +
      model.sparse.images[0].cam_from_world_translation;
  EXPECT_LT((ours - Eigen::Vector3d(1.3, -1.3, -5)).norm(), 1e-12);
  ASSERT_EQ(model.sparse.points.size(), 1u);
  EXPECT_EQ(model.sparse.points[0].xyz, Eigen::Vector3d(1, 2, -5));
  EXPECT_THAT(model.sparse.points[0].track, ElementsAre(0, 1, 1));
}

TEST_F(Pmvs, AnUnregisteredBundleImageIsMarkedNotFatal) {
  WriteFile(folder_ / "bundle.rd.out",
            "# Bundle file v0.3\n1 0\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n");
  EXPECT_TRUE(Read()
                  .sparse.images[0]
                  .cam_from_world_rotation.coeffs()
                  .array()
                  .isNaN()
                  .all());
}

TEST_F(Pmvs, BundleWinsOverVisDat) {
  WriteFile(folder_ / "bundle.rd.out", kBundle);
  WriteFile(folder_ / "vis.dat", "broken");
  EXPECT_EQ(Read().sparse.images.size(), 2u);
}

TEST_F(Pmvs, ProjectionMatricesAreSplitWhateverTheirScaleAndSign) {
  Eigen::Matrix3d calibration;
  calibration << 150, 0.25, 80, 0, 140, 60, 0, 0, 1;
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized())
          .toRotationMatrix();
  const Eigen::Vector3d translation(0.3, -1, 4);
  Eigen::Matrix<double, 3, 4> projection;
  projection << rotation, translation;
  projection = calibration * projection;
  WriteImagePlaceholders(3);
  WriteProjection(0, projection);
  WriteProjection(1, -projection);
  WriteProjection(2, 0.001 * projection);
  WriteFile(folder_ / "vis.dat", "VISDATA\n3\n0 2 1 2\n1 2 1 0\n2 0\n");
  const PmvsModel model = Read();
  ASSERT_EQ(model.sparse.images.size(), 3u);
  for (const SparseImage& image : model.sparse.images) {
    EXPECT_LT(
        (image.cam_from_world_rotation.toRotationMatrix() - rotation).norm(),
        1e-12);
    EXPECT_LT((image.cam_from_world_translation - translation).norm(), 1e-11);
    const auto& params = model.sparse.cameras.at(image.camera_id).params;
    const double expected[] = {150, 140, 80, 60};
    for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(params[i], expected[i], 1e-9);
  }
  ASSERT_TRUE(model.visible_images);
  EXPECT_THAT((*model.visible_images)[0], ElementsAre(1, 2));
  EXPECT_THAT((*model.visible_images)[1], ElementsAre(0));  // not itself
  EXPECT_THAT((*model.visible_images)[2], ElementsAre());

  const auto entries = MakePmvsCfgEntries(model, {1, 0});
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].ref_name, "00000001.jpg");
  EXPECT_THAT(entries[0].src_names, ElementsAre("00000000.jpg"));
  EXPECT_THAT(entries[1].src_names,
              ElementsAre("00000001.jpg", "00000002.jpg"));
}

TEST_F(Pmvs, ASingularProjectionIsMarkedNotFatal) {
  WriteImagePlaceholders(1);
  WriteProjection(0, Eigen::Matrix<double, 3, 4>::Zero());
  WriteFile(folder_ / "vis.dat", "VISDATA\n1\n0 0\n");
  EXPECT_FALSE(
      Read().sparse.images[0].cam_from_world_rotation.coeffs().allFinite());
}

TEST_F(Pmvs, WithoutVisibilitySourcesAreAutomatic) {
  WriteFile(folder_ / "bundle.rd.out", kBundle);
  const auto entries = MakePmvsCfgEntries(Read(), {0});
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].ref_name, "00000000.jpg");
  EXPECT_EQ(entries[0].sources, PatchMatchCfgEntry::Sources::kAuto);
  EXPECT_EQ(entries[0].max_num_auto, 20);
}

TEST_F(Pmvs, OptionFileListsOrRangesAndTheLastLineCounts) {
  const auto path = folder_ / "option-all";
  const auto read = [&](std::string_view text) {
    WriteFile(path, text);
    return ReadPmvsOptionFile(path, 10);
  };
  EXPECT_THAT(read("level 1\n# timages 1 9\ntimages 3 0 4 2\nsetEdge 0\n"),
              ElementsAre(0, 4, 2));
  EXPECT_THAT(read("timages -1 3 6\r\n"), ElementsAre(3, 4, 5));
  EXPECT_THAT(read("timages -1 8 10"), ElementsAre(8, 9));
  EXPECT_THAT(read("timages 1 0\ntimages 1 5\n"), ElementsAre(5));
}

TEST_F(Pmvs, HostileOptionLinesNameTheLine) {
  const auto path = folder_ / "option-all";
  for (const char* line : {"timages",
                           "timages x",
                           "timages 2 0",
                           "timages 1 0 1",
                           "timages 1 10",
                           "timages 1 -1",
                           "timages -1 0 11",
                           "timages -1 0 2147483647",
                           "timages -1 4 4",
                           "timages -2 0 1",
                           "timages 2147483647 0",
                           "timages 99999999999 0"}) {
    SCOPED_TRACE(line);
    WriteFile(path, std::string("level 1\n") + line + "\n");
    ExpectError(ErrorCode::kBadInput, "option-all:2:", [&] {
      ReadPmvsOptionFile(path, 10);
    });
  }
  WriteFile(path, "level 1\n");
  ExpectError(ErrorCode::kBadInput, "option-all", [&] {
    ReadPmvsOptionFile(path, 10);
  });
}

TEST_F(Pmvs, HostileBundlesAreRefused) {
  const std::string bundle = kBundle;
  const auto replaced = [&](std::string_view from, std::string_view to) {
    std::string text = bundle;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  for (const std::string& text : {std::string(),
                                  replaced("2 1\n", "-2 1\n"),
                                  replaced("2 1\n", "2 2147483647\n"),
                                  replaced("2 1\n", "2 99999999999\n"),
                                  replaced("150 0 0", "150 0.1 0"),
                                  replaced("150 0 0", "x 0 0"),
                                  replaced("3 1 7", "2147483646 1 7"),
                                  replaced("3 1 7", "3 2 7"),
                                  replaced("3 1 7", "3 -1 7")}) {
    WriteFile(folder_ / "bundle.rd.out", text);
    ExpectError(ErrorCode::kBadInput, "bundle.rd.out", [&] { Read(); });
  }
  // Nothing shorter is complete, except for the last digit of the last number.
  for (size_t length = 0; length + 2 < bundle.size(); ++length) {
    WriteFile(folder_ / "bundle.rd.out", bundle.substr(0, length));
    ExpectError(ErrorCode::kBadInput, "bundle.rd.out", [&] { Read(); });
  }
}

TEST_F(Pmvs, HostileVisibilityIsRefused) {
  WriteImagePlaceholders(1);
  WriteProjection(0, Eigen::Matrix<double, 3, 4>::Identity());
  for (const char* text : {"",
                           "NODATA 1 0 0",
                           "VISDATA 2 0 0 1 0",
                           "VISDATA 1 1 0",
                           "VISDATA 1 0 1 1",
                           "VISDATA 1 0 2147483646 0",
                           "VISDATA 1 0 -1"}) {
    WriteFile(folder_ / "vis.dat", text);
    ExpectError(ErrorCode::kBadInput, "vis.dat", [&] { Read(); });
  }
  WriteFile(folder_ / "vis.dat", "VISDATA 1 0 0");
  WriteFile(folder_ / "txt/00000000.txt", "CONTOUR 1 2 3");
  ExpectError(ErrorCode::kBadInput, "00000000.txt", [&] { Read(); });
}

TEST_F(Pmvs, AFolderWithoutModelIsNamed) {
  ExpectError(ErrorCode::kBadInput, folder_.path().string(), [&] { Read(); });
}

}  // namespace
}  // namespace hpm
