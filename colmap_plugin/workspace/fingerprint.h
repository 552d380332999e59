// Hash of everything a map depends on, so that resume never keeps a map made
// with other options. FNV-1a with 128 bits: the same on every machine; guards
// against accidents, not against attackers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hpm {

class Fingerprint {
 public:
  // Every value goes in with its kind (and length), so that neighbouring values
  // cannot run into each other: "ab","c" differs from "a","bc", 1 from 1.0.
  Fingerprint& AddInt(int64_t value);
  Fingerprint& AddDouble(double value);  // -0 counts as 0, all NaNs as one
  Fingerprint& AddString(std::string_view value);

  std::string Hex() const;  // 32 lower-case digits

 private:
  void AddWord(uint64_t word);
  void AddByte(uint8_t byte);

  uint64_t high_ = 0x6c62272e07bb0142u;  // FNV offset basis
  uint64_t low_ = 0x62b821756295c58du;
};

}  // namespace hpm
