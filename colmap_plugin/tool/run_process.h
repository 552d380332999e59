// RunTool with the streams, clock, signals and controller of this process.
#pragma once

#include <string>
#include <vector>

namespace hpm {

// `arguments` without the program's name. Takes over SIGINT, SIGTERM and
// SIGHUP. Returns the exit code of the process.
int RunProcess(const std::vector<std::string>& arguments);

}  // namespace hpm
