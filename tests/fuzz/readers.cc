#include "tests/fuzz/readers.h"

#include "colmap_plugin/formats/consistency_graph.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/formats/pmvs.h"
#include "colmap_plugin/formats/sparse_model.h"
#include "colmap_plugin/tool/parse_options.h"
#include "colmap_plugin/workspace/image_size.h"
#include "colmap_plugin/workspace/lock_owner.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/base/input_file.h"

#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace hpm {
namespace {

struct Reader {
  // The input is cut at kSeparator into these files; a '/' makes a folder.
  std::vector<std::string> files;
  std::function<void(const std::filesystem::path& folder)> read;
};

constexpr std::string_view kSeparator = "\xff--\xff";

const std::map<std::string, Reader>& Readers() {
  static const std::map<std::string, Reader> readers = {
      {"map", {{"a.bin"}, [](const auto& f) { ReadMap(f / "a.bin"); }}},
      {"graph",
       {{"a.bin"}, [](const auto& f) { ReadConsistencyGraph(f / "a.bin"); }}},
      {"cfg",
       {{"a.cfg"}, [](const auto& f) { ReadPatchMatchCfg(f / "a.cfg"); }}},
      {"image_size",
       {{"a.jpg"}, [](const auto& f) { ReadImageSize(f / "a.jpg"); }}},
      {"model_binary",
       {{"cameras.bin", "images.bin", "points3D.bin", "rigs.bin", "frames.bin"},
        [](const auto& f) { ReadSparseModel(f); }}},
      {"model_text",
       {{"cameras.txt", "images.txt", "points3D.txt", "rigs.txt", "frames.txt"},
        [](const auto& f) { ReadSparseModel(f); }}},
      // What is read back is written as it was.
      {"stamp",
       {{"stamps/s/a.json"},
        [](const auto& f) {
          const std::optional<Stamp> stamp = ReadStamp(f, "a", "s");
          if (!stamp) return;
          WriteStamp(f, "b", "s", *stamp);
          if (!ReadStamp(f, "b", "s")) std::abort();
        }}},
      {"lock",
       {{"lock"},
        [](const auto& f) {
          const std::optional<LockOwner> owner =
              ParseLockOwner(ReadWholeFile(f / "lock", 4096));
          if (!owner) return;
          IsVisible(*owner, ThisProcess());
          if (!ParseLockOwner(FormatLockOwner(*owner))) std::abort();
        }}},
      {"project_file",
       {{"project.ini"},
        [](const auto& f) {
          ParseOptions({"--project_path", (f / "project.ini").string()});
        }}},
      {"pmvs",
       {{"bundle.rd.out",
         "vis.dat",
         "option-all",
         "txt/00000000.txt",
         "txt/00000001.txt"},
        [](const auto& f) {
          ReadPmvsOptionFile(f / "option-all", 2);
          ReadPmvsModel(f, [](const auto&) { return std::pair(8, 6); });
        }}}};
  return readers;
}

}  // namespace

void ReadInput(const std::string& reader_name,
               std::string_view input,
               const std::filesystem::path& folder) {
  const Reader& reader = Readers().at(reader_name);
  for (const std::string& file : reader.files) {
    const std::filesystem::path path = folder / file;
    std::filesystem::create_directories(path.parent_path());
    const size_t end = input.find(kSeparator);
    std::ofstream(path, std::ios::binary) << input.substr(0, end);
    // What no part is left for is missing.
    if (end == std::string_view::npos && input.empty())
      std::filesystem::remove(path);
    input = end == std::string_view::npos
                ? std::string_view()
                : input.substr(end + kSeparator.size());
  }
  try {
    reader.read(folder);
  } catch (const Error&) {
  }
}

}  // namespace hpm
