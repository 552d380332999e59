// Completion for bash from the option table.
#pragma once

#include <string>

namespace hpm {

// A file for bash-completion's folder; needs nothing but bash itself.
std::string BashCompletion();

}  // namespace hpm
