// A fast hash of contents: XXH3 with 128 bits, by the package xxHash. The same
// on every machine; guards against accidents, not against attackers.
#pragma once

#include "src/base/cancel.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

struct XXH3_state_s;

namespace hpm {

// Of one piece of a file, for pieces that are written or read in any order.
struct PieceHash {
  uint64_t low = 0;
  uint64_t high = 0;
};
PieceHash HashPiece(const void* data, size_t num_bytes);

class ContentHash {
 public:
  ContentHash();

  // What is added counts as one, however it is divided.
  ContentHash& Add(const void* data, size_t num_bytes);

  std::string Hex() const;  // 32 lower-case digits

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Free> state_;
};

// Of all bytes of the file, a part at a time. Throws Error(kBadInput) for a
// file that cannot be read, Error(kInterrupted).
std::string HashFile(const std::filesystem::path& path,
                     const CancelToken& cancel);

}  // namespace hpm
