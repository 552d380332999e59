#include "src/cpu/cpu_target.h"

#include "src/base/error.h"
#include "src/base/remedies.h"
#include "src/base/simd_targets.h"
#include "src/cpu/geometric_error_scalar.h"
#include "src/cpu/geometric_error_simd.h"
#include "src/cpu/match_cost_scalar.h"
#include "src/cpu/match_cost_simd.h"

#include <algorithm>
#include <cctype>

namespace hpm {
namespace {

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return text;
}

}  // namespace

std::vector<CpuTarget> CpuTargets() {
  std::vector<CpuTarget> targets;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (target == HWY_SCALAR) continue;  // ours is the readable one
    targets.push_back({LowerCase(hwy::TargetName(target)),
                       SimdMatchCosts(target),
                       SimdGeometricErrors(target),
                       SimdLanes(target)});
  }
  targets.push_back({"scalar", &ScalarMatchCosts, &ScalarGeometricErrors});
  return targets;
}

CpuTarget FindCpuTarget(const std::string& name) {
  const std::vector<CpuTarget> targets = CpuTargets();
  if (name == "auto") return targets.front();
  std::string names = "auto";
  for (const CpuTarget& target : targets) {
    if (target.name == name) return target;
    names += ", " + target.name;
  }
  throw Error(ErrorCode::kUsage,
              std::string(kCpuTarget) + " " + name +
                  ": not available on this machine; use one of " + names);
}

}  // namespace hpm
