// Which programs the wrapper `colmap` hands its work to.
#pragma once

#include <filesystem>
#include <string_view>

namespace hpm {

// The first executable file `name` in the folders of `search_path` (separated
// as in PATH; an empty entry is the current folder) behind the last folder
// whose `name` is `self`. So a wrapper never finds itself, and two wrappers on
// one path never find each other in turn. Empty if there is none.
std::filesystem::path FindLater(std::string_view search_path,
                                std::string_view name,
                                const std::filesystem::path& self);

}  // namespace hpm
