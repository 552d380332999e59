// Damaged and hostile models: an error that names the file and the place, never
// a crash, a giant allocation or an endless loop.
#include "colmap_plugin/formats/sparse_model.h"
#include "tests/colmap_plugin/formats/tiny_model.h"

#include <limits>
#include <random>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr uint64_t kHuge = std::numeric_limits<uint64_t>::max();

// The tiny model, binary or text as the name of the changed file says, with all
// its rig files and this one file replaced.
void ExpectRefused(const std::string& name,
                   const std::string& bytes,
                   const std::string& part) {
  SCOPED_TRACE(name + ": " + part);
  const bool is_binary = name.find(".bin") != std::string::npos;
  ModelFiles files = is_binary ? Joined(TinyBinaryModel(), TinyRigFiles())
                               : Joined(TinyTextModel(), TinyTextRigFiles());
  files[name] = bytes;
  const ScratchFolder folder;
  WriteModel(folder.path(), files);
  ExpectError(
      ErrorCode::kBadInput, part, [&] { ReadSparseModel(folder.path()); });
  ExpectError(ErrorCode::kBadInput, (folder / name).string(), [&] {
    ReadSparseModel(folder.path());
  });
}

TEST(HostileModel, ClaimedCountsAreCheckedAgainstTheBytesThatFollow) {
  const ModelFiles tiny = Joined(TinyBinaryModel(), TinyRigFiles());
  for (const auto& [name, bytes] : tiny) {
    for (const uint64_t count : {kHuge, kHuge / 24 + 2, uint64_t{1000}}) {
      ExpectRefused(name, Counted(count, bytes.substr(8)), "(byte 0)");
    }
    ExpectRefused(name, "", "(byte 0)");
  }
  std::string image = ImageRecord(7, 1, "a.jpg");
  for (const uint64_t count : {kHuge, kHuge / 24 + 2, uint64_t{2}}) {
    image.replace(image.size() - 32, 8, Bytes().Add(count).str());
    ExpectRefused("images.bin", Counted(1, image), "image points");
  }
  std::string point = PointRecord(9, 1, {7});
  for (const uint64_t count : {kHuge, kHuge / 8 + 2, uint64_t{2}}) {
    point.replace(point.size() - 16, 8, Bytes().Add(count).str());
    ExpectRefused("points3D.bin", Counted(1, point), "track elements");
  }
  ExpectRefused("rigs.bin",
                Counted(1, Bytes().Add(uint32_t{1}).Add(~uint32_t{0}).str()),
                "sensors");
  ExpectRefused("frames.bin",
                Counted(1, FrameRecord(1, 1, "", ~uint32_t{0})),
                "data ids");
}

TEST(HostileModel, BinaryContradictionsNameTheRecord) {
  const std::string camera = CameraRecord(1, 1, 40, 30, 4);
  ExpectRefused("cameras.bin",
                Counted(2, camera + camera),
                "camera id 1 occurs twice (byte 64)");
  ExpectRefused("cameras.bin",
                Counted(1, CameraRecord(1, 18, 4, 3, 4)),
                "unknown camera model id 18 (byte 8)");
  ExpectRefused("cameras.bin",
                Counted(1, CameraRecord(1, -1, 4, 3, 4)),
                "unknown camera model id -1");
  for (const uint64_t size : {uint64_t{0}, uint64_t{1} << 31, kHuge}) {
    ExpectRefused("cameras.bin",
                  Counted(1, CameraRecord(1, 1, size, 3, 4)),
                  "camera 1 has the size");
  }
  const std::string image = ImageRecord(7, 1, "a.jpg");
  ExpectRefused("images.bin",
                Counted(2, image + image),
                "image id 7 occurs twice (byte 110)");
  ExpectRefused("images.bin",
                Counted(1, ImageRecord(7, 99, "a.jpg")),
                "unknown camera 99");
  ExpectRefused(
      "images.bin", Counted(3, std::string(5000, 'x')), "the name has no end");
  const std::string point = PointRecord(9, 1, {7});
  ExpectRefused("points3D.bin",
                Counted(2, point + point),
                "point id 9 occurs twice (byte 67)");
}

TEST(HostileModel, RigsAndFramesMustAgreeWithTheImages) {
  ExpectRefused("rigs.bin",
                Counted(2, RigRecord() + RigRecord()),
                "rig id 1 occurs twice");
  ExpectRefused("rigs.bin",
                Counted(1,
                        Bytes()
                            .Add(uint32_t{1})
                            .Add(uint32_t{1})
                            .Add(int32_t{5})
                            .Add(uint32_t{1})
                            .str()),
                "unknown sensor type 5");
  const auto sensor = [](uint32_t id) {
    return Bytes().Add(int32_t{0}).Add(id);
  };
  const std::string reference =
      Bytes().Add(uint32_t{1}).Add(uint32_t{2}).str() + sensor(1).str();
  ExpectRefused("rigs.bin",
                Counted(1, reference + sensor(1).Add(uint8_t{0}).str()),
                "rig 1 has sensor 1 twice (byte 8)");
  // COLMAP reads such a model and fails when it needs the pose.
  ModelFiles no_pose = Joined(TinyBinaryModel(), TinyRigFiles());
  no_pose["rigs.bin"] = Counted(1, reference + sensor(2).Add(uint8_t{0}).str());
  no_pose["frames.bin"] = Counted(
      1, FrameRecord(1, 1, DataRecord(0, 1, 7) + DataRecord(0, 2, 3), 2));
  const ScratchFolder no_pose_folder;
  WriteModel(no_pose_folder.path(), no_pose);
  ExpectError(ErrorCode::kBadInput,
              "frames.bin: frame 1 has image 3 of camera 2, which has no pose "
              "in rig 1 (byte 8)",
              [&] { ReadSparseModel(no_pose_folder.path()); });

  const auto frame = [](uint32_t rig, const std::string& data) {
    return FrameRecord(1, rig, data, static_cast<uint32_t>(data.size() / 16));
  };
  const std::string data = DataRecord(0, 1, 5);
  for (const auto& [record, part] : std::map<std::string, std::string>{
           {frame(2, data), "unknown rig 2"},
           {frame(1, DataRecord(0, 1, 99)), "unknown image 99"},
           {frame(1, DataRecord(0, 1, (uint64_t{1} << 32) + 5)),
            "unknown image 4294967301"},
           {frame(1, DataRecord(0, 2, 5)), "gives image 5 the camera 2"},
           {frame(1, DataRecord(0, 9, 5)), "which rig 1 lacks"},
           {frame(1, data), "image 7 is in no frame"}}) {
    ExpectRefused("frames.bin", Counted(1, record), part);
  }
  ExpectRefused("frames.bin",
                Counted(2, frame(1, data) + frame(1, data)),
                "frame id 1 occurs twice");
  ExpectRefused("frames.bin",
                Counted(2, frame(1, data) + FrameRecord(2, 1, data, 1)),
                "image 5 is in two frames");

  for (const char* missing : {"rigs.bin", "frames.bin"}) {
    ModelFiles files = Joined(TinyBinaryModel(), TinyRigFiles());
    files.erase(missing);
    const ScratchFolder folder;
    WriteModel(folder.path(), files);
    ExpectError(
        ErrorCode::kBadInput, missing, [&] { ReadSparseModel(folder.path()); });
  }
}

TEST(HostileModel, TextErrorsNameTheLine) {
  const std::string head = "# comment\n\n";
  ExpectRefused("cameras.txt", head + "1 NOPE 4 3 1 1 1 1", "cameras.txt:3:");
  for (const char* line : {"x PINHOLE 4 3 1 1 1 1",
                           "-1 PINHOLE 4 3 1 1 1 1",
                           "4294967296 PINHOLE 4 3 1 1 1 1",
                           "1 PINHOLE 4 3 1 1 1",
                           "1 PINHOLE 4 3 1 1 1 1 1",
                           "1 PINHOLE 4 3 1 1 1 1,5",
                           "1 PINHOLE 0 3 1 1 1 1",
                           "1 PINHOLE -4 3 1 1 1 1",
                           "1 PINHOLE 4 3 1 1 1 1e999",
                           "1"}) {
    ExpectRefused("cameras.txt", head + line, "cameras.txt:3:");
  }
  const std::string image = "7 1 0 0 0 0 0 0 1 a.jpg\n";
  ExpectRefused("images.txt", image + "\n" + image + "\n", "images.txt:3:");
  // Without its line of points the next image would be swallowed.
  ExpectRefused(
      "images.txt", image + "3 1 0 0 0 0 0 0 1 b.jpg\n", "images.txt:2:");
  ExpectRefused("images.txt", image + "1 2 -1 3 4\n", "images.txt:2:");
  ExpectRefused(
      "images.txt", "7 1 0 0 0 0 0 0 9 a.jpg\n\n", "unknown camera 9");
  ExpectRefused("images.txt", "7 1 0 0 0 0 0 0", "images.txt:1:");
  const std::string point = "9 1 2 3 1 2 3 0.5 7 0\n";
  ExpectRefused("points3D.txt",
                point + "\n" + point,
                "points3D.txt:3: point id 9 occurs twice");
  for (const char* id : {"400.5", "1e", "4294967296.0", "-1.0", "nan", "inf"}) {
    ExpectRefused("points3D.txt",
                  fmt::format("9 1 2 3 1 2 3 0.5 {} 0", id),
                  "expected an image id");
  }
  ExpectRefused("points3D.txt", "9 1 2 3 1 2 3 0.5 7", "points3D.txt:1:");
  ExpectRefused("points3D.txt", "9 1 2", "points3D.txt:1:");
  ExpectRefused("rigs.txt", "1 4000000000 CAMERA 1", "rigs.txt:1:");
  ExpectRefused(
      "rigs.txt", "1 2 CAMERA 1 CAMERA 2 2", "rigs.txt:1: expected 0");
  ExpectRefused("rigs.txt", "1 2 CAMERA 1 CAMERA 2 1 1 0 0", "rigs.txt:1:");
  ExpectRefused("rigs.txt", "1 1 LIDAR 1", "unknown sensor type 'LIDAR'");
  ExpectRefused(
      "frames.txt", "1 1 1 0 0 0 0 0 0 4000000000 CAMERA 1 5", "frames.txt:1:");
}

TEST(HostileModel, EveryProperPrefixAndEveryExtraByteOfABinaryFileIsRefused) {
  const ScratchFolder folder;
  const ModelFiles tiny = Joined(TinyBinaryModel(), TinyRigFiles());
  WriteModel(folder.path(), tiny);
  for (const auto& [name, bytes] : tiny) {
    for (size_t length = 0; length <= bytes.size() + 1; ++length) {
      if (length == bytes.size()) continue;
      SCOPED_TRACE(name + " " + std::to_string(length));
      std::string damaged = bytes;
      damaged.resize(length);
      WriteFile(folder / name, damaged);
      ExpectError(ErrorCode::kBadInput, (folder / name).string(), [&] {
        ReadSparseModel(folder.path());
      });
    }
    WriteFile(folder / name, bytes);
  }
  EXPECT_NO_THROW(ReadSparseModel(folder.path()));
}

// Reads a model with `num_flips` damaged bytes many times: the only permitted
// outcomes are a model and an Error.
void FlipBytes(const ModelFiles& tiny, unsigned seed) {
  std::mt19937 random(seed);
  const ScratchFolder folder;
  WriteModel(folder.path(), tiny);
  int num_errors = 0;
  for (int round = 0; round < 1500; ++round) {
    auto file = tiny.begin();
    std::advance(file, random() % tiny.size());
    std::string bytes = file->second;
    for (unsigned flips = 1 + random() % 4; flips > 0; --flips) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    WriteFile(folder / file->first, bytes);
    try {
      const SparseModel model = ReadSparseModel(folder.path());
      for (size_t i = 0; i < model.points.size(); ++i) {
        const SparsePoint point = model.points[i];
        for (const int index : point.track) {
          ASSERT_LT(static_cast<size_t>(index), model.images.size());
        }
      }
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput);
      ++num_errors;
    }
    WriteFile(folder / file->first, file->second);
  }
  EXPECT_GT(num_errors, 100);
}

TEST(HostileModel, RandomByteFlipsGiveAModelOrAnErrorInBinary) {
  FlipBytes(Joined(TinyBinaryModel(), TinyRigFiles()), 1);
}

TEST(HostileModel, RandomByteFlipsGiveAModelOrAnErrorInText) {
  FlipBytes(Joined(TinyTextModel(), TinyTextRigFiles()), 2);
}

}  // namespace
}  // namespace hpm
