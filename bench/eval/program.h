// What the small evaluation programs share: options that end with --help and
// one line for errors.
#pragma once

#include <functional>

#include <boost/program_options.hpp>

namespace hpm {

// Parses argv against `options` (to which --help is added; `positional` may be
// empty), then calls `run`. Returns the exit code: 0, or that of the error.
int RunProgram(
    int argc,
    char** argv,
    const char* summary,
    boost::program_options::options_description options,
    const boost::program_options::positional_options_description& positional,
    const std::function<void(const boost::program_options::variables_map&)>&
        run);

}  // namespace hpm
