#include "colmap_plugin/inspect/check_findings.h"

#include "src/base/error.h"

#include <algorithm>

#include <fmt/format.h>

namespace hpm {
namespace {

const char* NameOfKind(FindingKind kind) {
  switch (kind) {
    case FindingKind::kDamaged:
      return "damaged";
    case FindingKind::kUnreadable:
      return "unreadable";
    case FindingKind::kStale:
      return "stale";
    case FindingKind::kUnstamped:
      return "unstamped";
    case FindingKind::kForeign:
      return "foreign";
    case FindingKind::kMissing:
      break;
  }
  return "missing";
}

}  // namespace

int MapCheck::Count(FindingKind kind) const {
  return static_cast<int>(
      std::count_if(findings.begin(), findings.end(), [&](const Finding& f) {
        return f.kind == kind;
      }));
}

int MapCheck::ExitCode() const {
  bool all_good = true;
  for (const Finding& finding : findings) {
    if (finding.kind == FindingKind::kUnreadable ||
        (finding.kind == FindingKind::kDamaged && !finding.removed)) {
      return static_cast<int>(ErrorCode::kBadInput);
    }
    all_good = all_good && finding.kind == FindingKind::kForeign;
  }
  return all_good ? 0 : static_cast<int>(ErrorCode::kPartial);
}

std::string CheckText(const MapCheck& check) {
  std::string text;
  for (const Finding& finding : check.findings) {
    text += fmt::format("{:7} {}{}: {}\n",
                        NameOfKind(finding.kind),
                        finding.what,
                        finding.removed ? " (removed)" : "",
                        finding.reason);
  }
  const bool any_removable = std::any_of(
      check.findings.begin(), check.findings.end(), [](const Finding& f) {
        return f.kind == FindingKind::kDamaged && !f.removed;
      });
  if (any_removable)
    text += "--fix 1 removes what is damaged, and the next run makes it anew\n";
  if (check.Count(FindingKind::kStale) > 0) {
    text +=
        "give check the options of the run: with others all its maps are "
        "stale\n";
  }
  return text + fmt::format(
                    "{} files read: {} damaged, {} unreadable, {} stale, "
                    "{} unstamped, {} foreign, {} missing\n",
                    check.num_files,
                    check.Count(FindingKind::kDamaged),
                    check.Count(FindingKind::kUnreadable),
                    check.Count(FindingKind::kStale),
                    check.Count(FindingKind::kUnstamped),
                    check.Count(FindingKind::kForeign),
                    check.Count(FindingKind::kMissing));
}

}  // namespace hpm
