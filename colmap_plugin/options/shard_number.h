// "i/n": which of n shards of the images a process works on.
#pragma once

#include <optional>
#include <string_view>

namespace hpm {

struct ShardNumber {
  int index = 0;
  int count = 1;
};

// Nothing unless 0 <= i < n <= 100000, digits only.
std::optional<ShardNumber> ParseShard(std::string_view text);

}  // namespace hpm
