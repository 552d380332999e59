#include "src/base/platform/numbers.h"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string>
#include <system_error>

#include <locale.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif

namespace hpm {
namespace {

#ifdef _WIN32
template <class Float>
std::from_chars_result Read(const char* first, const char* last, Float* value) {
  return std::from_chars(first, last, *value);
}
#else

// The locale in which a point is a point; made once, kept to the end.
locale_t Classic() {
  static const locale_t classic = newlocale(LC_ALL_MASK, "C", nullptr);
  return classic;
}
double Parse(const char* text, char** end, double) {
  return strtod_l(text, end, Classic());
}
float Parse(const char* text, char** end, float) {
  return strtof_l(text, end, Classic());
}

bool BeginsNumber(const std::string& text) {
  const size_t digits = text[0] == '-' ? 1 : 0;
  if (digits == text.size()) return false;
  const char c = text[digits];
  return (c >= '0' && c <= '9') || c == '.' || c == 'i' || c == 'I' ||
         c == 'n' || c == 'N';
}

// strtod() reads them, from_chars() stops behind the zero.
bool IsHexadecimal(const std::string& text) {
  const size_t digits = text[0] == '-' ? 1 : 0;
  return text.size() > digits + 1 && text[digits] == '0' &&
         (text[digits + 1] == 'x' || text[digits + 1] == 'X');
}

template <class Float>
std::from_chars_result Read(const char* first, const char* last, Float* value) {
  std::string text(first, last);
  if (text.empty() || !BeginsNumber(text))
    return {first, std::errc::invalid_argument};
  if (IsHexadecimal(text)) text.resize(text.find('0') + 1);
  errno = 0;
  char* end = nullptr;
  const Float number = Parse(text.c_str(), &end, Float{});
  if (end == text.c_str()) return {first, std::errc::invalid_argument};
  const char* stop = first + (end - text.c_str());
  // Subnormal numbers are numbers, though strtod() may say ERANGE of them.
  if (errno == ERANGE && (std::isinf(number) || number == 0))
    return {stop, std::errc::result_out_of_range};
  *value = number;
  return {stop, std::errc()};
}
#endif

}  // namespace

std::from_chars_result FloatFromChars(const char* first,
                                      const char* last,
                                      float* value) {
  return Read(first, last, value);
}

std::from_chars_result FloatFromChars(const char* first,
                                      const char* last,
                                      double* value) {
  return Read(first, last, value);
}

}  // namespace hpm
