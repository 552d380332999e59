// Pieces of an HTML page.
#pragma once

#include <string>
#include <string_view>

namespace hpm {

// Text as the contents of an element or a quoted attribute, whatever it holds:
// bytes that are no UTF-8 and control characters become U+FFFD.
std::string Html(std::string_view text);

std::string Base64(std::string_view bytes);

}  // namespace hpm
