// What the binary and the text reader share: an error that names file and
// place.
#pragma once

#include <cstdint>
#include <string>

namespace hpm {

class InputCursor {
 public:
  virtual ~InputCursor() = default;

  // Byte offset of the current record or number of the current line.
  virtual uint64_t place() const = 0;

  [[noreturn]] void FailAt(uint64_t place, const std::string& what) const;
  [[noreturn]] void Fail(const std::string& what) const {
    FailAt(place(), what);
  }

 private:
  // The one-line message: file, what is wrong, place, remedy.
  virtual std::string Message(uint64_t place,
                              const std::string& what) const = 0;
};

}  // namespace hpm
