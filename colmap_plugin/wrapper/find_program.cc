#include "colmap_plugin/wrapper/find_program.h"

#include "src/base/platform/processes.h"

#include <string>
#include <system_error>

namespace hpm {
namespace fs = std::filesystem;

fs::path FindLater(std::string_view search_path,
                   std::string_view name,
                   const fs::path& self) {
  const std::string file = std::string(name) + kProgramSuffix;
  fs::path found;
  while (true) {
    const size_t separator = search_path.find(kSearchPathSeparator);
    const std::string_view folder = search_path.substr(0, separator);
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / file;
    std::error_code ignored;
    if (fs::equivalent(candidate, self, ignored)) {
      found.clear();
    } else if (found.empty() && fs::is_regular_file(candidate, ignored) &&
               IsExecutable(candidate)) {
      found = candidate;
    }
    if (separator == std::string_view::npos) return found;
    search_path.remove_prefix(separator + 1);
  }
}

}  // namespace hpm
