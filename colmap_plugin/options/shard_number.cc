#include "colmap_plugin/options/shard_number.h"

#include <algorithm>
#include <charconv>

namespace hpm {
namespace {

constexpr int kMaxShards = 100000;

std::optional<int> ParseDigits(std::string_view text) {
  const bool are_digits =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        return c >= '0' && c <= '9';
      });
  int value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value);
  if (!are_digits || error != std::errc()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<ShardNumber> ParseShard(std::string_view text) {
  const size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const std::optional<int> index = ParseDigits(text.substr(0, slash));
  const std::optional<int> count = ParseDigits(text.substr(slash + 1));
  if (!index || !count || *index >= *count || *count > kMaxShards)
    return std::nullopt;
  return ShardNumber{*index, *count};
}

}  // namespace hpm
