#include "colmap_plugin/tool/progress_line.h"

#include "colmap_plugin/tool/text.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr double kPlainInterval = 30;  // seconds
constexpr double kJsonInterval = 1;
constexpr double kEtaWeight = 0.3;  // of the newest prediction

// NaN, which would survive std::clamp, counts as no progress.
double CleanFraction(double fraction) {
  return fraction > 0 ? std::min(fraction, 1.0) : 0;
}

// Cut to `columns` bytes, not inside a UTF-8 character.
std::string Cut(std::string text, int columns) {
  const auto limit = static_cast<size_t>(std::max(columns, 1));
  if (text.size() <= limit) return text;
  size_t end = limit;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
    --end;
  text.resize(end);
  return text;
}

}  // namespace

void EtaEstimator::Update(double now, double fraction) {
  if (!started_) {
    started_ = true;
    start_time_ = now;
    start_fraction_ = fraction;
    return;
  }
  const double done = fraction - start_fraction_;
  if (done <= 0 || now <= start_time_) return;
  const double end = now + (now - start_time_) * (1 - fraction) / done;
  predicted_end_ = predicted_end_ < 0
                       ? end
                       : (1 - kEtaWeight) * predicted_end_ + kEtaWeight * end;
}

double EtaEstimator::Remaining(double now) const {
  return predicted_end_ < 0 ? -1 : std::max(predicted_end_ - now, 0.0);
}

ProgressLine::ProgressLine(std::ostream* out,
                           std::ostream* err,
                           bool terminal,
                           int columns,
                           Clock clock,
                           bool json)
    : out_(out),
      err_(err),
      json_(json),
      terminal_(terminal && !json),
      columns_(columns),
      clock_(std::move(clock)),
      start_time_(clock_()) {}

void ProgressLine::Log(LogLevel level, const std::string& message) {
  static const char* const kPrefix[] = {"", "WARNING: ", "ERROR: "};
  static const char* const kLevel[] = {"info", "warning", "error"};
  const std::lock_guard<std::mutex> lock(mutex_);
  if (json_) {
    WriteJson({{"event", "message"},
               {"level", kLevel[static_cast<int>(level)]},
               {"message", OneLine(message)}});
    return;
  }
  Erase();
  std::ostream& stream = level == LogLevel::kInfo ? *out_ : *err_;
  stream << kPrefix[static_cast<int>(level)] << OneLine(message) << '\n'
         << std::flush;
  Draw();
}

void ProgressLine::Update(const ProgressEvent& event) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now = clock_();
  eta_.Update(now, CleanFraction(event.fraction));
  if (json_) {
    const bool is_new = event.stage != stage_ || event.image.empty();
    if (!is_new && now - last_plain_time_ < kJsonInterval) return;
    stage_ = event.stage;
    last_plain_time_ = now;
    const double left = eta_.Remaining(now);
    WriteJson(
        {{"event", "progress"},
         {"stage", event.stage},
         {"title", event.title},
         {"image", event.image},
         {"image_number", event.image_number},
         {"num_images", event.num_images},
         {"fraction", CleanFraction(event.fraction)},
         {"seconds_left", left < 0 ? nlohmann::json() : nlohmann::json(left)}});
    return;
  }
  const std::string line = Render(event, now);
  if (terminal_) {
    Erase();
    line_ = Cut(line, columns_ - 1);  // a full last column would wrap
    Draw();
  } else if (event.stage != stage_ || event.image.empty() ||
             now - last_plain_time_ >= kPlainInterval) {
    stage_ = event.stage;
    last_plain_time_ = now;
    *out_ << line << '\n' << std::flush;
  }
}

void ProgressLine::Options(const nlohmann::json& options) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (json_) {
    WriteJson({{"event", "options"}, {"options", options}});
    return;
  }
  Erase();
  *out_ << "Options:\n";
  for (const auto& [name, value] : options.items()) {
    const std::string text =
        value.is_string() ? value.get<std::string>() : value.dump();
    *out_ << "  " << name << ": " << OneLine(text) << '\n';
  }
  *out_ << std::flush;
  Draw();
}

void ProgressLine::Result(nlohmann::json members) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!json_) return;
  members["event"] = "result";
  WriteJson(std::move(members));
}

void ProgressLine::Close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  Erase();
  line_.clear();
}

std::string ProgressLine::Render(const ProgressEvent& event, double now) const {
  const double fraction = CleanFraction(event.fraction);
  std::string line =
      fmt::format("[{:3.0f}%] {}: image {}/{}",
                  100 * fraction,
                  event.title.empty() ? event.stage : event.title,
                  event.image_number,
                  event.num_images);
  const double remaining = eta_.Remaining(now);
  if (remaining >= 0 && fraction < 1)
    line += ", " + FormatDuration(remaining) + " left";
  if (!event.image.empty()) line += ", " + event.image;
  return OneLine(line);
}

void ProgressLine::Erase() {
  if (terminal_ && !line_.empty()) *out_ << "\r\033[K" << std::flush;
}

void ProgressLine::WriteJson(nlohmann::json object) {
  object["time"] = clock_() - start_time_;
  // Image names are bytes, not always UTF-8.
  *out_ << object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
        << '\n'
        << std::flush;
}

void ProgressLine::Draw() {
  if (terminal_ && !line_.empty()) *out_ << line_ << std::flush;
}

}  // namespace hpm
