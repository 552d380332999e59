// Lines, words and numbers of an untrusted text file. A line may be as long as
// the file; numbers do not depend on the locale. Errors (kBadInput) name file
// and line.
#pragma once

#include "colmap_plugin/formats/input_cursor.h"
#include "src/base/input_file.h"
#include "src/base/platform/numbers.h"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hpm {

// Without blanks, tabs, CR and LF at both ends, the set that COLMAP trims.
std::string_view Trim(std::string_view text);

class LineReader : public InputCursor {
 public:
  explicit LineReader(const std::filesystem::path& path);

  // Moves to the next line; false at the end of the file. A byte order mark at
  // the start of the file is dropped.
  bool Next();
  std::string_view line() const {
    return line_;
  }  // trimmed; valid until Next()

  uint64_t place() const override { return line_number_; }

 private:
  std::string Message(uint64_t place, const std::string& what) const override;
  InputFile file_;
  uint64_t offset_ = 0;  // of the first byte after buffer_
  std::vector<char> buffer_;
  size_t buffer_begin_ = 0;
  size_t buffer_end_ = 0;
  std::string raw_line_;
  std::string_view line_;
  uint64_t line_number_ = 0;
};

// The words of one line, separated by blanks and tabs.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(Trim(text)) {}

  bool AtEnd() const { return rest_.empty(); }
  std::string_view Next();  // empty at the end
  std::string_view Rest() const { return rest_; }

 private:
  std::string_view rest_;
};

// The whole word must be the number; "nan" and "inf" are numbers, a leading '+'
// is allowed.
template <class T>
bool ParseNumber(std::string_view word, T* value) {
  static_assert(std::is_arithmetic_v<T>);
  if (word.size() > 1 && word[0] == '+' && word[1] != '-')
    word.remove_prefix(1);
  const auto [end, error] =
      FromChars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

// The whole number that the word is, written as one or as a floating-point
// number ("400.0", "1.2e+01": what scripts and numpy.savetxt make of it).
template <class T>
bool ParseInteger(std::string_view word, T* value) {
  if (ParseNumber(word, value)) return true;
  double number;
  if (!ParseNumber(word, &number) || std::floor(number) != number) return false;
  // 2^digits is the first that does not fit, and a double.
  if (number < static_cast<double>(std::numeric_limits<T>::min()) ||
      number >= std::ldexp(1.0, std::numeric_limits<T>::digits)) {
    return false;
  }
  *value = static_cast<T>(number);
  return true;
}

// The next word as a number, or an error at `cursor` that says what was
// expected.
template <class T>
T ReadNumber(const InputCursor& cursor, Words* words, const char* what) {
  T value;
  const std::string_view word = words->Next();
  bool ok;
  if constexpr (std::is_integral_v<T>) {
    ok = ParseInteger(word, &value);
  } else {
    ok = ParseNumber(word, &value);
  }
  if (!ok) cursor.Fail(std::string("expected ") + what);
  return value;
}

}  // namespace hpm
