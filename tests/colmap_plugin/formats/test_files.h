// Scratch folders, raw bytes and error expectations for the tests of file
// formats.
#pragma once

#include "src/base/error.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <stdexcept>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name =
        (std::filesystem::temp_directory_path() / "hpm_formats_XXXXXX")
            .string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  std::filesystem::path operator/(std::string_view name) const {
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

  size_t CountFiles() const {
    size_t count = 0;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(path_)) {
      count += entry.is_directory() ? 0 : 1;
    }
    return count;
  }

 private:
  std::filesystem::path path_;
};

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

inline void WriteBytes(const std::filesystem::path& path,
                       std::string_view bytes) {
  std::filesystem::create_directories(path.parent_path());
  // A truncated file is flushed to disk by some file systems; a new one is not.
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline std::string ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

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
