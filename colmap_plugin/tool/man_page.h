// The manual page hpm_mvs(1) from the option table.
#pragma once

#include <string>

namespace hpm {

// In the man macros of roff.
std::string ManPage();

}  // namespace hpm
