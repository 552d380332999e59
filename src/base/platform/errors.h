// The numbers of errors that some systems do not have, and so never give.
#pragma once

#include <cerrno>

#ifndef EDQUOT
#define EDQUOT 10069
#endif
#ifndef ESTALE
#define ESTALE 10070
#endif
