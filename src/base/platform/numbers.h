// Numbers of texts, whatever the locale. std::from_chars of floating-point
// numbers is missing from some libraries of C++17 (libc++, Apple's among them).
#pragma once

#include <charconv>
#include <type_traits>

namespace hpm {

// As std::from_chars in its general form: no blanks and no plus in front, no
// hexadecimal digits; "inf" and "nan" in any case. Numbers beyond the type are
// result_out_of_range. By the C library, but on Windows, which has the other.
std::from_chars_result FloatFromChars(const char* first,
                                      const char* last,
                                      float* value);
std::from_chars_result FloatFromChars(const char* first,
                                      const char* last,
                                      double* value);

template <class Number>
std::from_chars_result FromChars(const char* first,
                                 const char* last,
                                 Number* value) {
#if defined(__cpp_lib_to_chars)
  return std::from_chars(first, last, *value);
#else
  if constexpr (std::is_floating_point_v<Number>) {
    return FloatFromChars(first, last, value);
  } else {
    return std::from_chars(first, last, *value);
  }
#endif
}

}  // namespace hpm
