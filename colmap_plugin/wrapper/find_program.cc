#include "colmap_plugin/wrapper/find_program.h"

#include <system_error>

#include <unistd.h>

namespace hpm {
namespace fs = std::filesystem;

fs::path FindLater(std::string_view search_path,
                   std::string_view name,
                   const fs::path& self) {
  fs::path found;
  while (true) {
    const size_t colon = search_path.find(':');
    const std::string_view folder = search_path.substr(0, colon);
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / name;
    std::error_code ignored;
    if (fs::equivalent(candidate, self, ignored)) {
      found.clear();
    } else if (found.empty() && fs::is_regular_file(candidate, ignored) &&
               access(candidate.c_str(), X_OK) == 0) {
      found = candidate;
    }
    if (colon == std::string_view::npos) return found;
    search_path.remove_prefix(colon + 1);
  }
}

}  // namespace hpm
