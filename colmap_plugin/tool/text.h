// Small pieces of text for people.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hpm {

// Control characters, which file names and foreign messages may hold, become
// blanks.
std::string OneLine(std::string_view text);

// The beginning of what a user gave, and its length, if it is long.
std::string Shortened(const std::string& text);

// "45 s", "3 min 20 s", "1 h 02 min".
std::string FormatDuration(double seconds);

// `text` as one word of a POSIX shell, quoted only if it must be.
std::string ShellWord(const std::string& text);

// `text` in lines of at most `columns` bytes where it has blanks, each begun
// with `indent` blanks and ended with a newline.
std::string Wrap(std::string_view text, size_t columns, size_t indent);

// Of the names the one that a slip of the hand makes `word`: at most two
// letters wrong, missing, too many; '_' and '-' are one. Empty if there is
// none.
std::string LikelyName(std::string_view word,
                       const std::vector<std::string>& names);

}  // namespace hpm
