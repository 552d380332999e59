// The seeds of the fuzzers, and what can be cut from their ends, through the
// readers as the build's own compiler makes them.
#include "src/base/input_file.h"
#include "tests/base/scratch_folder.h"
#include "tests/fuzz/readers.h"

#include <filesystem>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(ReaderReplay, SeedsAndTheirBeginningsAreReadOrRefused) {
  const ScratchFolder folder;
  std::set<std::string> readers;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(HPM_FUZZ_SEEDS)) {
    const std::string reader = entry.path().parent_path().filename().string();
    // The matching cost is no reader.
    if (!entry.is_regular_file() || reader == "cost") continue;
    SCOPED_TRACE(entry.path());
    const std::string seed = ReadWholeFile(entry.path(), 1 << 20);
    constexpr size_t kNumCuts = 20;
    for (size_t i = 0; i <= kNumCuts; ++i) {
      ReadInput(reader,
                std::string_view(seed).substr(0, i * seed.size() / kNumCuts),
                folder / reader);
    }
    readers.insert(reader);
  }
  EXPECT_THAT(readers,
              testing::UnorderedElementsAre("cfg",
                                            "graph",
                                            "image_size",
                                            "lock",
                                            "map",
                                            "model_binary",
                                            "model_text",
                                            "pmvs",
                                            "project_file",
                                            "stamp"));
}

}  // namespace
}  // namespace hpm
