// fsync() is replaced by one that records what is synced, and what lies there
// then: a symbol of the program wins over the one of the C library.
#include "colmap_plugin/controller/stages.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace {

std::filesystem::path inner_maps;
// By path: whether the inner maps were there when it was synced.
std::map<std::string, bool> synced;

}  // namespace

extern "C" int fsync(int fd) {
  const auto path =
      std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(fd));
  synced[path.filename().string()] = std::filesystem::exists(inner_maps);
  return 0;
}

namespace hpm {
namespace {

TEST(RemoveInnerMaps, FirstSyncsTheStampsOfWhatWasMadeOfThem) {
  const SceneWorkspace scene(SmallScene(2, 12, 9));
  const Workspace workspace = scene.Open();
  inner_maps = workspace.StatePath() / "geometric_1";
  std::filesystem::create_directories(inner_maps);
  synced.clear();
  WriteStamp(workspace.StatePath(), "sub/a.jpg", "geometric", {});
  WriteStamp(workspace.StatePath(), "b.jpg", "photometric", {});
  WriteStamp(workspace.StatePath(), "c.jpg", "geometric_1", {});
  EXPECT_THAT(synced, testing::IsEmpty());
  RemoveInnerMaps(workspace);
  EXPECT_FALSE(std::filesystem::exists(inner_maps));
  EXPECT_THAT(synced,
              testing::UnorderedElementsAre(testing::Pair("a.jpg.json", true),
                                            testing::Pair("sub", true),
                                            testing::Pair("geometric", true),
                                            testing::Pair("b.jpg.json", true),
                                            testing::Pair("photometric", true),
                                            testing::Pair("stamps", true)));
}

}  // namespace
}  // namespace hpm
