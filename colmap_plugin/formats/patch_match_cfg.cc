#include "colmap_plugin/formats/patch_match_cfg.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/text_reader.h"
#include "src/base/error.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr std::string_view kSeparators = ",;";
constexpr std::string_view kAll = "__all__";
constexpr std::string_view kAuto = "__auto__";

std::vector<std::string> SplitSources(std::string_view line) {
  std::vector<std::string> items;
  while (!line.empty()) {
    const size_t end = std::min(line.find_first_of(kSeparators), line.size());
    const std::string_view item = Trim(line.substr(0, end));
    if (!item.empty()) items.emplace_back(item);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return items;
}

int ParseMaxNumAuto(const LineReader& lines, std::string_view word) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-')
    digits.remove_prefix(1);
  int64_t number = 0;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), number)
          .ec != std::errc()) {
    lines.Fail(fmt::format("expected a number after __auto__, found {}",
                           QuotedName(word)));
  }
  return static_cast<int>(
      std::clamp<int64_t>(number, -1, std::numeric_limits<int>::max()));
}

void ParseSources(const LineReader& lines, PatchMatchCfgEntry* entry) {
  std::vector<std::string> items = SplitSources(lines.line());
  if (items.size() == 1 && items[0] == kAll) {
    entry->sources = PatchMatchCfgEntry::Sources::kAll;
  } else if (items.size() == 2 && items[0] == kAuto) {
    entry->sources = PatchMatchCfgEntry::Sources::kAuto;
    entry->max_num_auto = ParseMaxNumAuto(lines, items[1]);
  } else {
    entry->sources = PatchMatchCfgEntry::Sources::kList;
    entry->src_names = std::move(items);
  }
}

// A line of a cfg file cannot hold every name.
void CheckName(const std::filesystem::path& path,
               const std::string& name,
               std::string_view forbidden) {
  if (name.empty() || Trim(name) != name ||
      name.find_first_of(forbidden) != std::string::npos ||
      name.find('\n') != std::string::npos) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("cannot write {}: the image name {} does not fit "
                            "its grammar; rename "
                            "the image in the sparse model",
                            path.string(),
                            QuotedName(name)));
  }
}

std::string FormatSources(const std::filesystem::path& path,
                          const PatchMatchCfgEntry& entry) {
  switch (entry.sources) {
    case PatchMatchCfgEntry::Sources::kAll:
      return std::string(kAll);
    case PatchMatchCfgEntry::Sources::kAuto:
      return fmt::format("{}, {}", kAuto, entry.max_num_auto);
    case PatchMatchCfgEntry::Sources::kList:
      break;
  }
  // The trailing separator is COLMAP's own habit. It also keeps an empty list
  // from being an empty line, which would turn the next reference into a source
  // line, and a first name that begins with '#' is the one thing it cannot
  // save.
  std::string line;
  for (const std::string& name : entry.src_names) {
    CheckName(path, name, kSeparators);
    line += name + ", ";
  }
  if (line.empty()) return ",";
  if (line.front() == '#') line.insert(0, ",");
  return line;
}

}  // namespace

PatchMatchCfg ReadPatchMatchCfg(const std::filesystem::path& path) {
  LineReader lines(path);
  PatchMatchCfg cfg;
  PatchMatchCfgEntry entry;
  while (lines.Next()) {
    const std::string_view line = lines.line();
    const int number = static_cast<int>(lines.place());
    if (line.empty()) continue;
    if (line.front() == '#') {
      cfg.comments.push_back({std::string(line), number});
      continue;
    }
    if (entry.ref_name.empty()) {
      entry.ref_name = line;
      entry.line = number;
      continue;
    }
    entry.src_line = number;
    ParseSources(lines, &entry);
    cfg.entries.push_back(std::move(entry));
    entry = PatchMatchCfgEntry();
  }
  cfg.unpaired = {entry.ref_name, entry.line};
  return cfg;
}

void WritePatchMatchCfg(const std::filesystem::path& path,
                        const std::vector<PatchMatchCfgEntry>& entries) {
  std::string text;
  for (const PatchMatchCfgEntry& entry : entries) {
    CheckName(path, entry.ref_name, "");
    if (entry.ref_name.front() == '#') CheckName(path, entry.ref_name, "#");
    text += entry.ref_name + '\n' + FormatSources(path, entry) + '\n';
  }
  WriteFileAtomically(path, text);
}

void WriteFusionCfg(const std::filesystem::path& path,
                    const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    CheckName(path, name, "");
    text += name + '\n';
  }
  WriteFileAtomically(path, text);
}

}  // namespace hpm
