// --help, --version and docs/options.md, all from the option table.
#pragma once

#include <string>

namespace hpm {

std::string VersionLine();

std::string HelpText();

// The contents of docs/options.md.
std::string OptionsMarkdown();

}  // namespace hpm
