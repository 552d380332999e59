#include "colmap_plugin/formats/input_cursor.h"

#include "src/base/error.h"

namespace hpm {

void InputCursor::FailAt(uint64_t place, const std::string& what) const {
  throw Error(ErrorCode::kBadInput, Message(place, what));
}

}  // namespace hpm
