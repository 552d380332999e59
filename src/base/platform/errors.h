// The numbers of errors: those that some systems do not have, and so never
// give, and what std::filesystem says as numbers of errno.
#pragma once

#include <cerrno>
#include <system_error>

#ifndef EDQUOT
#define EDQUOT 10069
#endif
#ifndef ESTALE
#define ESTALE 10070
#endif

namespace hpm {

// 0: none. What has no such number is EIO.
int ErrnoOf(const std::error_code& error);

}  // namespace hpm
