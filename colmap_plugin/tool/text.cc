#include "colmap_plugin/tool/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <fmt/format.h>

namespace hpm {
namespace {

// Levenshtein's distance, with '_' and '-' as one letter.
size_t Distance(std::string_view a, std::string_view b) {
  const auto letter = [](char c) { return c == '-' ? '_' : c; };
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (letter(a[i]) != letter(b[j]));
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j + 1] + 1, row[j] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

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

std::string LikelyName(std::string_view word,
                       const std::vector<std::string>& names) {
  constexpr size_t kMostWrong = 2;
  size_t best = std::min(kMostWrong, word.size() / 3) + 1;
  std::string likely;
  for (const std::string& name : names) {
    // Cheap, and long words are not compared at all.
    const size_t longer = std::max(word.size(), name.size());
    if (longer - std::min(word.size(), name.size()) >= best) continue;
    const size_t distance = Distance(word, name);
    if (distance >= best) continue;
    best = distance;
    likely = name;
  }
  return likely;
}

}  // namespace hpm
