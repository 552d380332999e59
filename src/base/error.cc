#include "src/base/error.h"

namespace hpm {

Error::Error(ErrorCode code, const std::string& message)
    : std::runtime_error(message), code_(code) {}

}  // namespace hpm
