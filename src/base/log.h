// Where messages go. The library never prints; the tool installs a sink.
#pragma once

#include <functional>
#include <string>

namespace hpm {

enum class LogLevel { kInfo = 0, kWarning = 1, kError = 2 };

// Must be callable from several threads at once. One call = one line, without
// newline.
using LogSink = std::function<void(LogLevel, const std::string&)>;

}  // namespace hpm
