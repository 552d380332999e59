#include "colmap_plugin/workspace/cfg_check.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/formats/text_reader.h"
#include "src/base/error.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr const char* kRightForm =
    "write two lines per image: its name, then '__auto__, 20' (or '__all__', "
    "or "
    "the names of its source images with commas between them)";

[[noreturn]] void Fail(const std::filesystem::path& path,
                       int line,
                       const std::string& what) {
  throw Error(ErrorCode::kBadInput,
              fmt::format("{}:{}: {}", path.string(), line, what));
}

// In any case of letters, with whatever behind it.
bool IsKeyword(const std::string& text) {
  std::string start = text.substr(0, 8);
  for (char& c : start) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return start == "__auto__" || start.substr(0, 7) == "__all__";
}

// Several names of the model with blanks between them.
bool IsListWithBlanks(const Workspace& workspace, const std::string& text) {
  int num = 0;
  for (Words words(text); !words.AtEnd(); ++num) {
    if (workspace.ImageIndex(std::string(words.Next())) < 0) return false;
  }
  return num > 1;
}

// A source line of one name that is no reference itself: more often than a
// source it is the next image of a plain list.
std::vector<const PatchMatchCfgEntry*> SwallowedNames(
    const Workspace& workspace, const PatchMatchCfg& cfg) {
  std::set<std::string> references;
  for (const PatchMatchCfgEntry& entry : cfg.entries)
    references.insert(entry.ref_name);
  std::vector<const PatchMatchCfgEntry*> swallowed;
  for (const PatchMatchCfgEntry& entry : cfg.entries) {
    if (entry.sources == PatchMatchCfgEntry::Sources::kList &&
        entry.src_names.size() == 1 &&
        workspace.ImageIndex(entry.src_names[0]) >= 0 &&
        references.count(entry.src_names[0]) == 0) {
      swallowed.push_back(&entry);
    }
  }
  return swallowed;
}

}  // namespace

std::string RemedyForName(const Workspace& workspace, const std::string& name) {
  if (IsKeyword(name)) return kRightForm;
  if (IsListWithBlanks(workspace, name))
    return "put commas between the names of a list of source images";
  return "correct the name or remove it";
}

void CheckCfg(const Workspace& workspace,
              const std::filesystem::path& path,
              const PatchMatchCfg& cfg,
              const LogSink& log) {
  for (const PatchMatchCfgLine& comment : cfg.comments) {
    if (workspace.ImageIndex(comment.text) < 0) continue;
    Fail(path,
         comment.line,
         fmt::format("{} is an image of the sparse model, but lines that begin "
                     "with '#' are comments, for COLMAP too; rename the image "
                     "in the sparse model and its file",
                     QuotedName(comment.text)));
  }
  std::vector<PatchMatchCfgLine> references;
  for (const PatchMatchCfgEntry& entry : cfg.entries)
    references.push_back({entry.ref_name, entry.line});
  references.push_back(cfg.unpaired);
  for (const PatchMatchCfgLine& reference : references) {
    if (!IsKeyword(reference.text) || workspace.ImageIndex(reference.text) >= 0)
      continue;
    Fail(path,
         reference.line,
         fmt::format("{} stands where the name of an image is expected; {}",
                     QuotedName(reference.text),
                     kRightForm));
  }
  const std::vector<const PatchMatchCfgEntry*> swallowed =
      SwallowedNames(workspace, cfg);
  if (!cfg.unpaired.text.empty()) {
    const std::string what =
        fmt::format("{} has no line of source images behind it",
                    QuotedName(cfg.unpaired.text));
    if (!swallowed.empty())
      Fail(path, cfg.unpaired.line, what + "; " + kRightForm);
    if (log) {
      log(LogLevel::kWarning,
          fmt::format("{}:{}: {} and is left out; {}",
                      path.string(),
                      cfg.unpaired.line,
                      what,
                      kRightForm));
    }
  }
  if (!log) return;
  if (!swallowed.empty()) {
    const PatchMatchCfgEntry& first = *swallowed.front();
    log(LogLevel::kWarning,
        fmt::format("{}:{}: {} is read as the only source image of {}, not as "
                    "an image to compute{}; if that is not meant, {}",
                    path.string(),
                    first.src_line,
                    QuotedName(first.src_names[0]),
                    QuotedName(first.ref_name),
                    swallowed.size() > 1
                        ? fmt::format(" ({} lines like it)", swallowed.size())
                        : "",
                    kRightForm));
  }
}

}  // namespace hpm
