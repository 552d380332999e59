// The readers of files that come from elsewhere, by name, for the fuzzers and
// for the test that replays their seeds.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hpm {

// Puts the input into files in the folder. The reader may throw Error, which is
// caught here, and nothing else.
void ReadInput(const std::string& reader_name,
               std::string_view input,
               const std::filesystem::path& folder);

}  // namespace hpm
