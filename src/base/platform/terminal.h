// The terminal, and the three streams that a program is born with.
#pragma once

namespace hpm {

bool IsStandardOutputATerminal();
// 0 where unknown.
int TerminalColumns();

// Opens the null device on those of the descriptors 0 to 2 that are closed.
// Else the next file that is opened would get such a number, and what a library
// says on standard error would land in it.
void OpenStandardStreams();

}  // namespace hpm
