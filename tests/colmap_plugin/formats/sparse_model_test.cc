#include "colmap_plugin/formats/sparse_model.h"

#include "colmap_plugin/formats/text_reader.h"
#include "tests/colmap_plugin/formats/tiny_model.h"

#include <limits>
#include <regex>
#include <sstream>

#include <fmt/format.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

SparseModel ReadFiles(const ModelFiles& files) {
  const ScratchFolder folder;
  WriteModel(folder.path(), files);
  return ReadSparseModel(folder.path());
}

std::vector<uint32_t> ImageIds(const SparseModel& model) {
  std::vector<uint32_t> ids;
  for (const SparseImage& image : model.images) ids.push_back(image.id);
  return ids;
}

void ExpectTinyModel(const SparseModel& model) {
  ASSERT_EQ(model.cameras.size(), 2u);
  EXPECT_EQ(model.cameras.at(1).model, "PINHOLE");
  EXPECT_EQ(model.cameras.at(1).width, 40u);
  EXPECT_EQ(model.cameras.at(1).height, 30u);
  EXPECT_THAT(model.cameras.at(1).params, ElementsAre(100, 101, 102, 103));
  EXPECT_EQ(model.cameras.at(2).model, "SIMPLE_PINHOLE");
  EXPECT_THAT(ImageIds(model), ElementsAre(7, 3, 5));
  EXPECT_EQ(model.images[0].name, "a b.jpg");
  EXPECT_EQ(model.images[1].name, "c/d.jpg");
  EXPECT_EQ(model.images[1].camera_id, 2u);
  EXPECT_EQ(model.images[0].cam_from_world_rotation.w(), -1);
  EXPECT_EQ(model.images[0].cam_from_world_translation,
            Eigen::Vector3d(0.5, -1, 2));
  ASSERT_EQ(model.points.size(), 2u);
  EXPECT_EQ(model.points[0].xyz, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(model.points[0].track, ElementsAre(0, 0, 1));
  EXPECT_THAT(model.points[1].track, ElementsAre(2));
}

TEST(SparseModel, BinaryFieldsArriveInTheirPlaces) {
  ExpectTinyModel(ReadFiles(TinyBinaryModel()));
}

TEST(SparseModel, TextGivesTheSameModelInAnyLocale) {
  const CommaLocale locale;
  ExpectTinyModel(ReadFiles(TinyTextModel()));
}

TEST(SparseModel, TextWithWindowsLineEndsGivesTheSameModel) {
  ModelFiles files = TinyTextModel();
  for (auto& [name, text] : files) {
    std::string crlf;
    for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c);
    text = crlf;
  }
  ExpectTinyModel(ReadFiles(files));
}

TEST(SparseModel, CompleteBinaryWinsOverText) {
  ModelFiles files = TinyBinaryModel();
  for (const auto& [name, text] : TinyTextModel()) files[name] = "broken";
  ExpectTinyModel(ReadFiles(files));
}

TEST(SparseModel, IncompleteBinaryFallsBackToText) {
  for (const auto& missing : TinyBinaryModel()) {
    ModelFiles files = TinyTextModel();
    for (const auto& [name, bytes] : TinyBinaryModel()) files[name] = "broken";
    files.erase(missing.first);
    ExpectTinyModel(ReadFiles(files));
  }
}

TEST(SparseModel, NoCompleteModelNamesTheFolder) {
  const ScratchFolder folder;
  ExpectError(ErrorCode::kBadInput, folder.path().string(), [&] {
    ReadSparseModel(folder.path());
  });
}

TEST(SparseModel, FramesOrderTheImagesAndTracksFollow) {
  for (const ModelFiles& files :
       {Joined(TinyBinaryModel(), TinyRigFiles()),
        Joined(TinyTextModel(), TinyTextRigFiles())}) {
    const SparseModel model = ReadFiles(files);
    EXPECT_THAT(ImageIds(model), ElementsAre(5, 7, 3));
    EXPECT_EQ(model.images[0].name, "e.jpg");
    EXPECT_THAT(model.points[0].track, ElementsAre(1, 1, 2));
    EXPECT_THAT(model.points[1].track, ElementsAre(0));
  }
}

// COLMAP 3.12 and later ignores the poses of the images file then.
TEST(SparseModel, PosesComeFromRigsAndFrames) {
  // A quarter turn about y, then one to the right.
  const TestPose turned = {3, 0, 3, 0, 1, 0, 0};
  for (const auto& [extension, files] : std::map<std::string, ModelFiles>{
           {".bin", Joined(TinyBinaryModel(), TinyRigFiles(turned))},
           {".txt", Joined(TinyTextModel(), TinyTextRigFiles(turned))}}) {
    const ScratchFolder folder;
    WriteModel(folder.path(), files);
    std::vector<std::string> warnings;
    const SparseModel model = ReadSparseModel(
        folder.path(), [&](LogLevel level, const std::string& line) {
          EXPECT_EQ(level, LogLevel::kWarning);
          warnings.push_back(line);
        });
    ASSERT_THAT(ImageIds(model), ElementsAre(5, 7, 3));
    const Eigen::Vector3d in_rig(0.5, -1, 2);
    for (const size_t i : {0, 1}) {
      EXPECT_EQ(model.images[i].cam_from_world_rotation.w(), 1);
      EXPECT_EQ(model.images[i].cam_from_world_translation, in_rig);
    }
    const SparseImage& image = model.images[2];
    EXPECT_NEAR(
        (image.cam_from_world_translation - Eigen::Vector3d(2 + 1, -1, -0.5))
            .norm(),
        0,
        1e-12);
    EXPECT_NEAR((image.cam_from_world_rotation * Eigen::Vector3d(1, 2, 3) -
                 Eigen::Vector3d(3, 2, -1))
                    .norm(),
                0,
                1e-12);
    ASSERT_EQ(warnings.size(), 1u);
    for (const std::string& part : {std::string("1 of 3 images"),
                                    std::string("'c/d.jpg' by 90 degrees"),
                                    "images" + extension,
                                    "rigs" + extension}) {
      EXPECT_THAT(warnings[0], testing::HasSubstr(part));
    }
  }
}

TEST(SparseModel, RigsThatAgreeWithTheImagesChangeNothing) {
  const ScratchFolder folder;
  ModelFiles files = Joined(TinyTextModel(), TinyTextRigFiles());
  // As much as the digits of a text file take away.
  std::string& images = files["images.txt"];
  images.replace(images.find("3 1 0 0 0"), 9, "3 1 1e-6 0 0");
  WriteModel(folder.path(), files);
  ReadSparseModel(folder.path(), [](LogLevel, const std::string& line) {
    ADD_FAILURE() << line;
  });
}

TEST(SparseModel, EmptyRigsAndFramesAreALegacyModel) {
  ExpectTinyModel(ReadFiles(
      Joined(TinyBinaryModel(),
             {{"rigs.bin", Counted(0, "")}, {"frames.bin", Counted(0, "")}})));
}

TEST(SparseModel, LastTextImageMayLackItsLineOfPoints) {
  ModelFiles files = TinyTextModel();
  std::string& text = files["images.txt"];
  text.resize(text.rfind("3.5 nan"));
  ExpectTinyModel(ReadFiles(files));
}

TEST(SparseModel, UnusablePosesAreMarkedAndDoNotFailTheModel) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double qw : {0.0, inf, nan}) {
    ModelFiles files = TinyBinaryModel();
    files["images.bin"] = Counted(1, ImageRecord(7, 1, "a.jpg", qw));
    files["points3D.bin"] = Counted(0, "");
    const SparseModel model = ReadFiles(files);
    EXPECT_TRUE(
        model.images[0].cam_from_world_rotation.coeffs().array().isNaN().all());
  }
  ModelFiles files = TinyTextModel();
  files["images.txt"] =
      "7 nan 0 0 0 0 0 0 1 a.jpg\n\n3 1 0 0 0 inf -nan 0 1 b.jpg\n\n"
      "5 1 0 0 0 0 0 0 1 c.jpg\n\n";
  const SparseModel model = ReadFiles(files);
  EXPECT_EQ(model.images.size(), 3u);
  EXPECT_FALSE(model.images[1].cam_from_world_translation.allFinite());
}

TEST(SparseModel, QuaternionsOfAnyScaleAreNormalised) {
  for (const double qw : {1e-320, 1e-200, 3.0, 1e200, 1.7e308}) {
    ModelFiles files = TinyBinaryModel();
    files["images.bin"] = Counted(1, ImageRecord(7, 1, "a.jpg", qw));
    files["points3D.bin"] = Counted(0, "");
    EXPECT_EQ(ReadFiles(files).images[0].cam_from_world_rotation.w(), 1) << qw;
  }
}

// Every word but names, models and the marks of rigs, as numpy.savetxt writes
// it.
std::string AsFloats(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      uint64_t number;
      if (ParseNumber(word, &number) && number < 1000)
        word = fmt::format("{:.18e}", static_cast<double>(number));
      result += word + " ";
    }
    result += "\n";
  }
  return result;
}

TEST(SparseModel, WholeNumbersMayBeWrittenAsFloats) {
  ModelFiles files = Joined(TinyTextModel(), TinyTextRigFiles());
  const SparseModel expected = ReadFiles(files);
  for (auto& [name, text] : files) {
    // Names have blanks, and a rig's lines are not numbers alone.
    if (name != "images.txt" && name != "rigs.txt") text = AsFloats(text);
  }
  files["images.txt"] = std::regex_replace(files["images.txt"],
                                           std::regex("(^|\\n)(\\d+) "),
                                           std::string("$1$2.0 "));
  EXPECT_NE(files["cameras.txt"], TinyTextModel()["cameras.txt"]);
  const SparseModel model = ReadFiles(files);
  EXPECT_EQ(ImageIds(model), ImageIds(expected));
  EXPECT_EQ(model.cameras.at(1).width, 40u);
  EXPECT_THAT(model.points[0].track,
              ElementsAreArray(expected.points[0].track));
}

TEST(SparseModel, IdsOfImagePointsMayBeAnyNumber) {
  for (const char* id : {"-1", "-1.0", "18446744073709551615", "1.8e+19"}) {
    ModelFiles files = TinyTextModel();
    files["images.txt"] = fmt::format(
        "7 1 0 0 0 0 0 0 1 a.jpg\n1 2 {0} 3 4 {0}\n"
        "3 1 0 0 0 0 0 0 1 b.jpg\n\n5 1 0 0 0 0 0 0 1 c.jpg\n\n",
        id);
    EXPECT_EQ(ReadFiles(files).images.size(), 3u) << id;
  }
}

TEST(SparseModel, TracksMayNameImagesThatWereFilteredOut) {
  ModelFiles binary = TinyBinaryModel(), text = TinyTextModel();
  binary["points3D.bin"] =
      Counted(2, PointRecord(9, 1, {99, 7, 98, 7}) + PointRecord(8, 1, {99}));
  text["points3D.txt"] =
      "9 1 2 3 1 2 3 0.5 99 0 7 0 98 0 7 1\n8 1 2 3 1 2 3 0.5 99 0\n";
  for (const ModelFiles& files : {binary, text}) {
    const SparseModel model = ReadFiles(files);
    ASSERT_EQ(model.points.size(), 2u);
    EXPECT_THAT(model.points[0].track, ElementsAre(0, 0));
    EXPECT_TRUE(model.points[1].track.empty());
    EXPECT_EQ(model.num_observations, 5u);
    EXPECT_EQ(model.num_left_out, 3u);
    EXPECT_EQ(model.left_out_example, 99u);
  }
}

TEST(SparseModel, PointsThatAreNotFiniteAreLeftOut) {
  ModelFiles files = TinyBinaryModel();
  files["points3D.bin"] =
      Counted(2,
              PointRecord(9, std::numeric_limits<double>::quiet_NaN(), {7}) +
                  PointRecord(4, 1, {3}));
  const SparseModel model = ReadFiles(files);
  ASSERT_EQ(model.points.size(), 1u);
  EXPECT_THAT(model.points[0].track, ElementsAre(1));
}

TEST(SparseModel, EveryKnownCameraModelHasItsNumberOfParameters) {
  const int num_params[] = {
      3, 4, 4, 5, 8, 8, 12, 5, 4, 5, 12, 16, 4, 5, 3, 4, 6, 2};
  for (int32_t id = 0; id < 18; ++id) {
    ModelFiles files = TinyBinaryModel();
    files["cameras.bin"] = Counted(2,
                                   CameraRecord(1, id, 40, 30, num_params[id]) +
                                       CameraRecord(2, 0, 20, 10, 3));
    const SparseModel model = ReadFiles(files);
    EXPECT_EQ(model.cameras.at(1).params.size(),
              static_cast<size_t>(num_params[id]));
    EXPECT_EQ(model.cameras.at(2).width, 20u);
  }
}

}  // namespace
}  // namespace hpm
