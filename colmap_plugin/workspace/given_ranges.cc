#include "colmap_plugin/workspace/given_ranges.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/text_reader.h"
#include "src/base/error.h"

#include <cmath>
#include <string>
#include <string_view>

namespace hpm {
namespace {

// Takes the last word off the text.
std::string_view TakeLast(std::string_view* text) {
  const size_t blank = text->find_last_of(" \t");
  if (blank == std::string_view::npos) return "";
  const std::string_view word = text->substr(blank + 1);
  *text = Trim(text->substr(0, blank));
  return word;
}

}  // namespace

std::map<int, DepthRange> ReadGivenRanges(const Workspace& workspace,
                                          const std::filesystem::path& path) {
  std::map<int, DepthRange> ranges;
  if (path.empty()) return ranges;
  LineReader lines(path);
  while (lines.Next()) {
    std::string_view line = lines.line();
    if (line.empty() || line[0] == '#') continue;
    DepthRange range;
    const bool are_numbers = ParseNumber(TakeLast(&line), &range.max) &&
                             ParseNumber(TakeLast(&line), &range.min);
    if (!are_numbers || !std::isfinite(range.max) || !(range.min >= 0) ||
        !(range.min <= range.max) || !(range.max > 0) || line.empty()) {
      lines.Fail(
          "expected IMAGE NEAR FAR with 0 <= NEAR <= FAR, in model units");
    }
    const std::string name(line);
    const int image = workspace.ImageIndex(name);
    if (image < 0) {
      lines.Fail("the sparse model has no image " + QuotedName(name) +
                 "; give names as in images/");
    }
    if (!ranges.emplace(image, range).second)
      lines.Fail("a second range for " + QuotedName(name) + "; remove one");
  }
  return ranges;
}

}  // namespace hpm
