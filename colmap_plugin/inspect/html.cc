#include "colmap_plugin/inspect/html.h"

#include <cstddef>
#include <cstdint>

namespace hpm {
namespace {

constexpr const char* kUnknown = "\xEF\xBF\xBD";  // U+FFFD

// Bytes of the UTF-8 character that begins at `at`; 0 if there is none.
size_t CharacterAt(std::string_view text, size_t at) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  const uint8_t first = byte(at);
  size_t length = 0;
  uint32_t code = 0;
  if (first < 0x80) return first >= 0x20 && first != 0x7f;
  if (first >= 0xC2 && first < 0xE0) length = 2, code = first & 0x1F;
  if (first >= 0xE0 && first < 0xF0) length = 3, code = first & 0x0F;
  if (first >= 0xF0 && first < 0xF5) length = 4, code = first & 0x07;
  if (length == 0 || at + length > text.size()) return 0;
  for (size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(at + i) & 0x3F);
  }
  const bool is_too_long =
      (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool is_character =
      code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
  // 0x80 ... 0x9F are control characters.
  return !is_too_long && is_character && code >= 0xA0 ? length : 0;
}

}  // namespace

std::string Html(std::string_view text) {
  std::string html;
  for (size_t at = 0; at < text.size();) {
    const size_t length = CharacterAt(text, at);
    if (length == 0) {
      html += kUnknown;
      ++at;
      continue;
    }
    const std::string_view character = text.substr(at, length);
    at += length;
    if (character == "&") {
      html += "&amp;";
    } else if (character == "<") {
      html += "&lt;";
    } else if (character == ">") {
      html += "&gt;";
    } else if (character == "\"") {
      html += "&quot;";
    } else if (character == "'") {
      html += "&#39;";
    } else {
      html += character;
    }
  }
  return html;
}

std::string Base64(std::string_view bytes) {
  constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t three = 0;
    for (size_t j = 0; j < 3; ++j) {
      three = three << 8 |
              (i + j < bytes.size() ? static_cast<uint8_t>(bytes[i + j]) : 0);
    }
    for (size_t j = 0; j < 4; ++j) {
      text += i + j > bytes.size() ? '=' : kDigits[three >> (18 - 6 * j) & 63];
    }
  }
  return text;
}

}  // namespace hpm
