// Raw bytes, error expectations and locales for the tests of file formats.
#pragma once

#include "src/base/error.h"
#include "tests/base/scratch_folder.h"

#include <locale>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {

// Little-endian bytes, spelled out field by field.
class Bytes {
 public:
  template <class T>
  Bytes& Add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  Bytes& Text(std::string_view text) {
    bytes_.append(text);
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
};

// Runs `action`, which must throw an Error of this code whose one-line message
// holds `part`.
template <class Action>
void ExpectError(ErrorCode code, const std::string& part, Action action) {
  try {
    action();
    ADD_FAILURE() << "no error; expected one with: " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_THAT(error.what(), testing::HasSubstr(part));
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
  }
}

// A decimal comma and grouped digits: what a German locale does to streams.
class CommaLocale {
 public:
  CommaLocale()
      : previous_(std::locale::global(
            std::locale(std::locale::classic(), new Punctuation))) {}
  ~CommaLocale() { std::locale::global(previous_); }

 private:
  class Punctuation : public std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::locale previous_;
};

}  // namespace hpm
