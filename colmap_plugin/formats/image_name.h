// Image names come from untrusted files and become paths.
#pragma once

#include <string>
#include <string_view>

namespace hpm {

// Throws Error(kBadInput) for empty, absolute or '..' names, for names of a
// folder
// ("a/", "a/.") and for control characters. Nested folders are legal.
void CheckImageName(const std::string& name);

// Whether CheckImageName() accepts the name.
bool IsImageName(std::string_view name);

// Names written on Windows have backslashes where others have '/'.
std::string WithSlashes(std::string name);

// For messages: quoted, control characters as \xNN, cut at 100 bytes.
std::string QuotedName(std::string_view name);

}  // namespace hpm
