// A global locale with a decimal comma and digit groups, as long as the object
// lives.
#pragma once

#include <locale>
#include <string>

namespace hpm {

class CommaLocale {
 public:
  CommaLocale()
      : previous_(
            std::locale::global(std::locale(std::locale(), new Punctuation))) {}
  ~CommaLocale() { std::locale::global(previous_); }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  struct Punctuation : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::locale previous_;
};

}  // namespace hpm
