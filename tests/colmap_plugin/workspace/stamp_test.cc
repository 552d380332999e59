#include "colmap_plugin/workspace/stamp.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

namespace hpm {
namespace {

Stamp StampOf(const std::string& fingerprint,
              const nlohmann::json& statistics = nullptr) {
  return {fingerprint, {}, statistics, {}};
}

std::string FingerprintIn(const std::filesystem::path& state,
                          const std::string& image,
                          const std::string& stage = "geometric") {
  const std::optional<Stamp> stamp = ReadStamp(state, image, stage);
  return stamp ? stamp->fingerprint : "none";
}

TEST(Stamp, GivesBackWhatWasWrittenPerImageAndStage) {
  const ScratchFolder state;
  Stamp written = StampOf("1234", {{"seconds", 1.5}});
  // More than 32 bits each.
  written.files["depth"] = {{5000000000, 1790000000123456789}, "abc"};
  WriteStamp(state.path(), "cam1/a.jpg", "photometric", written);
  WriteStamp(state.path(), "cam1/a.jpg", "geometric", StampOf("5678"));
  EXPECT_EQ(FingerprintIn(state.path(), "cam1/a.jpg"), "5678");
  EXPECT_EQ(FingerprintIn(state.path(), "cam2/a.jpg"), "none");
  const std::optional<Stamp> read =
      ReadStamp(state.path(), "cam1/a.jpg", "photometric");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->fingerprint, "1234");
  EXPECT_EQ(read->statistics, written.statistics);
  ASSERT_EQ(read->files.count("depth"), 1u);
  EXPECT_EQ(read->files.at("depth").state, written.files["depth"].state);
  EXPECT_EQ(read->files.at("depth").checksum, "abc");
}

TEST(Stamp, IsReplacedByALaterOne) {
  const ScratchFolder state;
  WriteStamp(state.path(), "a.jpg", "geometric", StampOf("old"));
  WriteStamp(state.path(), "a.jpg", "geometric", StampOf("new"));
  EXPECT_EQ(FingerprintIn(state.path(), "a.jpg"), "new");
}

TEST(Stamp, StatisticsCannotReplaceTheFingerprint) {
  const ScratchFolder state;
  WriteStamp(state.path(),
             "a.jpg",
             "geometric",
             StampOf("right", {{"fingerprint", "wrong"}}));
  EXPECT_EQ(FingerprintIn(state.path(), "a.jpg"), "right");
}

TEST(Stamp, StatisticsNeedNotBeUtf8) {
  const ScratchFolder state;
  WriteStamp(state.path(),
             "a.jpg",
             "geometric",
             StampOf("1", {{"source", "\xff\xfe.jpg"}}));
  EXPECT_EQ(FingerprintIn(state.path(), "a.jpg"), "1");
}

TEST(Stamp, EveryProperPrefixCountsAsAbsent) {
  const ScratchFolder state;
  Stamp stamp = StampOf("1234", {{"pixels", 12}, {"zeros", {1, 2}}});
  stamp.files["depth"] = {{12, 34}, "abc"};
  WriteStamp(state.path(), "a.jpg", "geometric", stamp);
  const std::filesystem::path path =
      StampPath(state.path(), "a.jpg", "geometric");
  EXPECT_EQ(FingerprintIn(state.path(), "a.jpg"), "1234");
  for (size_t size = std::filesystem::file_size(path); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    EXPECT_EQ(FingerprintIn(state.path(), "a.jpg"), "none") << size;
  }
}

TEST(Stamp, HostileContentsCountAsAbsent) {
  const ScratchFolder state;
  const std::filesystem::path path =
      StampPath(state.path(), "a.jpg", "geometric");
  for (const std::string& text :
       {std::string("[1]"),
        // Of the first version, which vouched for no map.
        std::string(R"({"fingerprint": "7"})"),
        std::string(R"({"version": 1, "fingerprint": "7", "files": {}})"),
        std::string(R"({"version": "2", "fingerprint": "7", "files": {}})"),
        std::string(R"({"version": 2, "fingerprint": 7, "files": {}})"),
        std::string(R"({"version": 2, "fingerprint": "7"})"),
        std::string(R"({"version": 2, "fingerprint": "7", "files": []})"),
        std::string(R"({"version": 2, "fingerprint": "7", "files": {"a": 1}})"),
        std::string(R"({"version": 2, "fingerprint": "7",
                        "files": {"a": {"bytes": 1, "time_ns": 2}}})"),
        std::string(500000, '['),
        std::string(R"({"version": 2, "fingerprint": "7", "files": {}})") +
            std::string(2 << 20, ' ')}) {
    WriteFile(path, text);
    EXPECT_EQ(FingerprintIn(state.path(), "a.jpg"), "none")
        << text.substr(0, 90);
  }
  std::filesystem::remove(path);
  std::filesystem::create_directory(path);
  EXPECT_EQ(FingerprintIn(state.path(), "a.jpg"), "none");
}

TEST(Stamp, RefusesNamesOutsideTheFolder) {
  const ScratchFolder state;
  for (const char* name :
       {"../a.jpg", "/a.jpg", "x/../../a.jpg", "", "a\n.jpg"}) {
    const auto error = ErrorOf(
        [&] { WriteStamp(state.path(), name, "geometric", StampOf("1")); });
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  }
}

}  // namespace
}  // namespace hpm
