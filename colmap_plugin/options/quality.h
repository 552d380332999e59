// Effort in one word: each quality stands for values of documented options.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hpm {

struct Quality {
  std::string name;
  // Option name and value, as a user would write them.
  std::vector<std::pair<std::string, std::string>> settings;
};

// From the fastest to the most thorough; "high" holds the defaults.
const std::vector<Quality>& Qualities();

std::vector<std::string> QualityNames();

}  // namespace hpm
