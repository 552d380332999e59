#include "colmap_plugin/workspace/stamp.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

namespace hpm {
namespace {

TEST(Stamp, GivesBackTheFingerprintPerImageAndStage) {
  const ScratchFolder state;
  WriteStamp(
      state.path(), "cam1/a.jpg", "photometric", "1234", {{"seconds", 1.5}});
  WriteStamp(state.path(), "cam1/a.jpg", "geometric", "5678", nullptr);
  EXPECT_EQ(ReadStampFingerprint(state.path(), "cam1/a.jpg", "photometric"),
            "1234");
  EXPECT_EQ(ReadStampFingerprint(state.path(), "cam1/a.jpg", "geometric"),
            "5678");
  EXPECT_EQ(ReadStampFingerprint(state.path(), "cam2/a.jpg", "geometric"),
            std::nullopt);
  const nlohmann::json stamp = nlohmann::json::parse(
      ReadFile(state.path() / "stamps/photometric/cam1/a.jpg.json"));
  EXPECT_EQ(stamp["seconds"], 1.5);
}

TEST(Stamp, IsReplacedByALaterOne) {
  const ScratchFolder state;
  WriteStamp(state.path(), "a.jpg", "geometric", "old", nullptr);
  WriteStamp(state.path(), "a.jpg", "geometric", "new", nullptr);
  EXPECT_EQ(ReadStampFingerprint(state.path(), "a.jpg", "geometric"), "new");
}

TEST(Stamp, StatisticsCannotReplaceTheFingerprint) {
  const ScratchFolder state;
  WriteStamp(
      state.path(), "a.jpg", "geometric", "right", {{"fingerprint", "wrong"}});
  EXPECT_EQ(ReadStampFingerprint(state.path(), "a.jpg", "geometric"), "right");
}

TEST(Stamp, StatisticsNeedNotBeUtf8) {
  const ScratchFolder state;
  WriteStamp(
      state.path(), "a.jpg", "geometric", "1", {{"source", "\xff\xfe.jpg"}});
  EXPECT_EQ(ReadStampFingerprint(state.path(), "a.jpg", "geometric"), "1");
}

TEST(Stamp, EveryProperPrefixCountsAsAbsent) {
  const ScratchFolder state;
  WriteStamp(state.path(),
             "a.jpg",
             "geometric",
             "1234",
             {{"pixels", 12}, {"zeros", {1, 2}}});
  const std::filesystem::path path =
      StampPath(state.path(), "a.jpg", "geometric");
  EXPECT_EQ(ReadStampFingerprint(state.path(), "a.jpg", "geometric"), "1234");
  for (size_t size = std::filesystem::file_size(path); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    EXPECT_EQ(ReadStampFingerprint(state.path(), "a.jpg", "geometric"),
              std::nullopt)
        << size;
  }
}

TEST(Stamp, HostileContentsCountAsAbsent) {
  const ScratchFolder state;
  const std::filesystem::path path =
      StampPath(state.path(), "a.jpg", "geometric");
  for (const std::string& text :
       {std::string("[1]"),
        std::string("{\"fingerprint\": 7}"),
        std::string("{\"other\": \"7\"}"),
        std::string(500000, '['),
        std::string("{\"fingerprint\": \"7\"}") + std::string(2 << 20, ' ')}) {
    WriteFile(path, text);
    EXPECT_EQ(ReadStampFingerprint(state.path(), "a.jpg", "geometric"),
              std::nullopt)
        << text.substr(0, 30);
  }
  std::filesystem::remove(path);
  std::filesystem::create_directory(path);
  EXPECT_EQ(ReadStampFingerprint(state.path(), "a.jpg", "geometric"),
            std::nullopt);
}

TEST(Stamp, RefusesNamesOutsideTheFolder) {
  const ScratchFolder state;
  for (const char* name :
       {"../a.jpg", "/a.jpg", "x/../../a.jpg", "", "a\n.jpg"}) {
    const auto error = ErrorOf(
        [&] { WriteStamp(state.path(), name, "geometric", "1", nullptr); });
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  }
}

}  // namespace
}  // namespace hpm
