#include "colmap_plugin/formats/content_hash.h"

#include "src/base/input_file.h"

#include <new>
#include <vector>

#include <fmt/format.h>
#include <xxhash.h>

namespace hpm {
namespace {

constexpr size_t kPartBytes = 1 << 18;

}  // namespace

PieceHash HashPiece(const void* data, size_t num_bytes) {
  const XXH128_hash_t hash = XXH3_128bits(data, num_bytes);
  return {hash.low64, hash.high64};
}

ContentHash::ContentHash() : state_(XXH3_createState()) {
  if (state_ == nullptr) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

ContentHash& ContentHash::Add(const void* data, size_t num_bytes) {
  XXH3_128bits_update(state_.get(), data, num_bytes);
  return *this;
}

std::string ContentHash::Hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

void ContentHash::Free::operator()(XXH3_state_s* state) const {
  XXH3_freeState(state);
}

std::string HashFile(const std::filesystem::path& path,
                     const CancelToken& cancel) {
  const InputFile file(path);
  std::vector<char> part(kPartBytes);
  ContentHash hash;
  for (uint64_t offset = 0;;) {
    cancel.ThrowIfCancelled();
    const size_t num_read = file.ReadAt(offset, part.data(), part.size());
    hash.Add(part.data(), num_read);
    if (num_read < part.size()) return hash.Hex();
    offset += num_read;
  }
}

}  // namespace hpm
