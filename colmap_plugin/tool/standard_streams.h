// Standard input, output and error of a program that was started without them.
#pragma once

namespace hpm {

// Opens /dev/null on those of the descriptors 0 to 2 that are closed. Else the
// next file that is opened would get such a number, and what a library says on
// standard error would land in it.
void OpenStandardStreams();

}  // namespace hpm
