// Image names come from untrusted files and become paths.
#pragma once

#include <string>

namespace hpm {

// Throws Error(kBadInput) for empty, absolute or '..' names and for control
// characters. Nested folders are legal.
void CheckImageName(const std::string& name);

}  // namespace hpm
