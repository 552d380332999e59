#include "colmap_plugin/formats/patch_match_cfg.h"

#include "tests/colmap_plugin/formats/test_files.h"

#include <chrono>
#include <cstring>

namespace hpm {
namespace {

using Sources = PatchMatchCfgEntry::Sources;
using testing::ElementsAre;

class PatchMatchCfgTest : public testing::Test {
 protected:
  std::vector<PatchMatchCfgEntry> Read(std::string_view text) {
    WriteFile(path_, text);
    return ReadPatchMatchCfg(path_).entries;
  }

  // The entry of a file with the one reference "r" and this source line.
  PatchMatchCfgEntry ReadSources(const std::string& line) {
    const auto entries = Read("r\n" + line + "\n");
    EXPECT_EQ(entries.size(), 1u);
    return entries.at(0);
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "patch-match.cfg";
};

TEST_F(PatchMatchCfgTest, ReadsTheThreeKindsOfSources) {
  const auto entries = Read(
      "a.jpg\n__all__\n"
      "b.jpg\n__auto__, 20\n"
      "c.jpg\na.jpg, b.jpg;a.jpg\n");
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[0].ref_name, "a.jpg");
  EXPECT_EQ(entries[0].sources, Sources::kAll);
  EXPECT_EQ(entries[1].sources, Sources::kAuto);
  EXPECT_EQ(entries[1].max_num_auto, 20);
  EXPECT_EQ(entries[2].sources, Sources::kList);
  EXPECT_THAT(entries[2].src_names, ElementsAre("a.jpg", "b.jpg", "a.jpg"));
  EXPECT_EQ(entries[2].line, 5);
  EXPECT_EQ(entries[2].src_line, 6);
}

TEST_F(PatchMatchCfgTest, CommentsBlanksCrlfAndByteOrderMarkAreNoEntries) {
  const auto entries = Read(
      "\xEF\xBB\xBF# head\r\n\r\n \t a b.jpg \t\r\n# between\r\n   \r\n"
      "  # indented\r\n c # no comment.jpg ,\r\n");
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].ref_name, "a b.jpg");
  EXPECT_EQ(entries[0].line, 3);
  EXPECT_THAT(entries[0].src_names, ElementsAre("c # no comment.jpg"));
}

TEST_F(PatchMatchCfgTest, ByteOrderMarkBeforeAReferenceIsNotPartOfIt) {
  EXPECT_EQ(Read("\xEF\xBB\xBF"
                 "a\n__all__\n")
                .at(0)
                .ref_name,
            "a");
}

TEST_F(PatchMatchCfgTest, ReferencesAreTakenWhole) {
  EXPECT_EQ(Read("a, b;c.jpg\n__all__").at(0).ref_name, "a, b;c.jpg");
  EXPECT_EQ(Read("__auto__, 20\n__all__").at(0).ref_name, "__auto__, 20");
}

TEST_F(PatchMatchCfgTest, RunsOfSeparatorsAreOneAndEmptyItemsAreDropped) {
  EXPECT_THAT(ReadSources(",;, a ,;, b ;, ").src_names, ElementsAre("a", "b"));
  EXPECT_TRUE(ReadSources(",;").src_names.empty());
  EXPECT_EQ(ReadSources("__all__,").sources, Sources::kAll);
  EXPECT_EQ(ReadSources(";__auto__;7,").max_num_auto, 7);
}

TEST_F(PatchMatchCfgTest, KeywordsOfAnotherShapeAreNames) {
  EXPECT_THAT(ReadSources("__auto__").src_names, ElementsAre("__auto__"));
  EXPECT_THAT(ReadSources("__auto__,").src_names, ElementsAre("__auto__"));
  EXPECT_THAT(ReadSources("__auto__, 5, 6").src_names,
              ElementsAre("__auto__", "5", "6"));
  EXPECT_THAT(ReadSources("__all__, x").src_names, ElementsAre("__all__", "x"));
  EXPECT_THAT(ReadSources("__ALL__").src_names, ElementsAre("__ALL__"));
}

TEST_F(PatchMatchCfgTest, TheNumberOfAutoIsTheLeadingInteger) {
  EXPECT_EQ(ReadSources("__auto__, 20abc").max_num_auto, 20);
  EXPECT_EQ(ReadSources("__auto__, 3.9").max_num_auto, 3);
  EXPECT_EQ(ReadSources("__auto__, +4").max_num_auto, 4);
  EXPECT_EQ(ReadSources("__auto__, 0").max_num_auto, 0);
  EXPECT_LT(ReadSources("__auto__, -1").max_num_auto, 0);
  EXPECT_LT(ReadSources("__auto__, -9000000000").max_num_auto, 0);
  EXPECT_EQ(ReadSources("__auto__, 9000000000").max_num_auto, 2147483647);
}

TEST_F(PatchMatchCfgTest, AutoWithoutANumberNamesFileAndLine) {
  for (const char* number : {"x", "-", "+", "+-3", "99999999999999999999"}) {
    SCOPED_TRACE(number);
    ExpectError(ErrorCode::kBadInput, "patch-match.cfg:5:", [&] {
      Read(std::string("a\n__all__\n\nr\n__auto__, ") + number + "\n");
    });
  }
}

TEST_F(PatchMatchCfgTest, WhatIsNoEntryIsKeptWithItsLine) {
  WriteFile(path_, "# head\na\n__all__\nb\n  #end\n");
  const PatchMatchCfg cfg = ReadPatchMatchCfg(path_);
  EXPECT_EQ(cfg.entries.size(), 1u);
  EXPECT_EQ(cfg.unpaired.text, "b");
  EXPECT_EQ(cfg.unpaired.line, 4);
  ASSERT_EQ(cfg.comments.size(), 2u);
  EXPECT_EQ(cfg.comments[1].text, "#end");
  EXPECT_EQ(cfg.comments[1].line, 5);
  WriteFile(path_, "");
  EXPECT_TRUE(ReadPatchMatchCfg(path_).entries.empty());
  EXPECT_EQ(ReadPatchMatchCfg(path_).unpaired.text, "");
}

TEST_F(PatchMatchCfgTest, ALineOfTenMegabytesIsReadInASecond) {
  std::string line;
  while (line.size() < 10'000'000) line += "some/image.jpg, ";
  const size_t num_names = line.size() / 16;
  const auto start = std::chrono::steady_clock::now();
  const auto entries = Read(line + "\n" + line + "\n");
  const std::chrono::duration<double> time =
      std::chrono::steady_clock::now() - start;
  EXPECT_EQ(entries.at(0).src_names.size(), num_names);
  EXPECT_LT(time.count(), 5.0);
  WriteFile(path_, "r\n__auto__, " + std::string(10'000'000, 'x'));
  try {
    ReadPatchMatchCfg(path_);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_LT(std::strlen(error.what()), 1000u);
  }
}

TEST_F(PatchMatchCfgTest, WritesColmapsLinesByteForByte) {
  const CommaLocale locale;
  PatchMatchCfgEntry list;
  list.ref_name = "c, d.jpg";
  list.sources = Sources::kList;
  list.src_names = {"a.jpg", "b.jpg"};
  PatchMatchCfgEntry automatic;
  automatic.ref_name = "a.jpg";
  automatic.max_num_auto = 2000;
  PatchMatchCfgEntry all;
  all.ref_name = "b.jpg";
  all.sources = Sources::kAll;
  WritePatchMatchCfg(path_, {automatic, all, list});
  EXPECT_EQ(ReadFile(path_),
            "a.jpg\n__auto__, 2000\nb.jpg\n__all__\n"
            "c, d.jpg\na.jpg, b.jpg, \n");
}

TEST_F(PatchMatchCfgTest, EveryWritableListComesBackUnchanged) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{}, {"a"}, {"#a", "b"}, {"a b", "c # d"}}) {
    PatchMatchCfgEntry entry;
    entry.ref_name = "r";
    entry.sources = Sources::kList;
    entry.src_names = names;
    WritePatchMatchCfg(path_, {entry, entry});
    const auto entries = ReadPatchMatchCfg(path_).entries;
    ASSERT_EQ(entries.size(), 2u);
    EXPECT_EQ(entries[1].ref_name, "r");
    EXPECT_EQ(entries[1].src_names, names);
  }
}

TEST_F(PatchMatchCfgTest, NamesThatTheGrammarCannotHoldAreRefused) {
  for (const char* name : {"", "#a", " a", "a\t", "a\nb"}) {
    PatchMatchCfgEntry entry;
    entry.ref_name = name;
    ExpectError(ErrorCode::kBadInput, "patch-match.cfg", [&] {
      WritePatchMatchCfg(path_, {entry});
    });
  }
  for (const char* name : {"", "a,b", "a;b", "a\nb"}) {
    PatchMatchCfgEntry entry;
    entry.ref_name = "r";
    entry.sources = Sources::kList;
    entry.src_names = {name};
    ExpectError(ErrorCode::kBadInput, "patch-match.cfg", [&] {
      WritePatchMatchCfg(path_, {entry});
    });
  }
  ExpectError(ErrorCode::kBadInput, "fusion.cfg", [&] {
    WriteFusionCfg(folder_ / "fusion.cfg", {"a\nb"});
  });
  EXPECT_EQ(folder_.CountFiles(), 0u);
}

TEST_F(PatchMatchCfgTest, FusionCfgIsOneNamePerLine) {
  WriteFusionCfg(folder_ / "fusion.cfg", {"a, b.jpg", "#c.jpg"});
  EXPECT_EQ(ReadFile(folder_ / "fusion.cfg"), "a, b.jpg\n#c.jpg\n");
}

}  // namespace
}  // namespace hpm
