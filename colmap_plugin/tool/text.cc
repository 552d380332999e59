#include "colmap_plugin/tool/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace hpm {

std::string OneLine(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f) c = ' ';
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

std::string Shortened(const std::string& text) {
  constexpr size_t kMost = 200;
  constexpr size_t kShown = 60;
  if (text.size() <= kMost) return text;
  return fmt::format(
      "{}... ({} characters)", text.substr(0, kShown), text.size());
}

std::string FormatDuration(double seconds) {
  // A month is as good as "for ever" and keeps the conversion defined.
  const auto whole = static_cast<int64_t>(
      std::llround(std::clamp(seconds, 0.0, 31 * 86400.0)));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600)
    return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string ShellWord(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           (c >= '0' && c <= '9') ||
           std::string_view("/._-+:,@%").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain))
    return text;
  std::string quoted = "'";
  for (const char c : text)
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string Wrap(std::string_view text, size_t columns, size_t indent) {
  std::string wrapped;
  std::string line;
  while (!text.empty()) {
    const size_t blank = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, blank);
    text.remove_prefix(std::min(blank + 1, text.size()));
    if (!line.empty() && indent + line.size() + 1 + word.size() > columns) {
      wrapped += std::string(indent, ' ') + line + '\n';
      line.clear();
    }
    if (!line.empty()) line += ' ';
    line += word;
  }
  return wrapped + std::string(indent, ' ') + line + '\n';
}

}  // namespace hpm
