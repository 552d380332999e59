#include "colmap_plugin/workspace/fingerprint.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

namespace hpm {

Fingerprint& Fingerprint::AddInt(int64_t value) {
  AddByte('i');
  AddWord(static_cast<uint64_t>(value));
  return *this;
}

Fingerprint& Fingerprint::AddDouble(double value) {
  if (value == 0) value = 0;
  if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
  uint64_t bits = 0;
  static_assert(sizeof(bits) == sizeof(value));
  std::memcpy(&bits, &value, sizeof(bits));
  AddByte('d');
  AddWord(bits);
  return *this;
}

Fingerprint& Fingerprint::AddString(std::string_view value) {
  AddByte('s');
  AddWord(value.size());
  for (const char c : value) AddByte(static_cast<uint8_t>(c));
  return *this;
}

std::string Fingerprint::Hex() const {
  return fmt::format("{:016x}{:016x}", high_, low_);
}

void Fingerprint::AddWord(uint64_t word) {
  for (int shift = 0; shift < 64; shift += 8)
    AddByte(static_cast<uint8_t>(word >> shift));
}

// hash = (hash ^ byte) * (2^88 + 0x13b) modulo 2^128, in two 64-bit halves.
void Fingerprint::AddByte(uint8_t byte) {
  constexpr uint64_t kPrimeLow = 0x13b;
  low_ ^= byte;
  const uint64_t low_product = (low_ & 0xffffffffu) * kPrimeLow;
  const uint64_t middle_product =
      (low_ >> 32) * kPrimeLow + (low_product >> 32);
  high_ = high_ * kPrimeLow + (middle_product >> 32) + (low_ << 24);
  low_ = (middle_product << 32) | (low_product & 0xffffffffu);
}

}  // namespace hpm
