// Where the program's messages meet its progress. On a terminal the progress is
// one line, rewritten in place below the log; elsewhere it is a plain line at
// the start and end of a stage and every 30 s.
#pragma once

#include "colmap_plugin/controller/controller.h"
#include "src/base/log.h"

#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>

#include <nlohmann/json.hpp>

namespace hpm {

// Time that is left, from the share of the work done since the first Update().
// The predicted end is smoothed, so that one slow image does not make it jump.
class EtaEstimator {
 public:
  // `now` in seconds, `fraction` of the work in 0..1.
  void Update(double now, double fraction);
  // Negative while nothing is known.
  double Remaining(double now) const;

 private:
  bool started_ = false;
  double start_time_ = 0;
  double start_fraction_ = 0;
  double predicted_end_ = -1;
};

class ProgressLine {
 public:
  using Clock = std::function<double()>;  // seconds, never going back

  // Info lines and progress go to `out`, warnings and errors to `err`. json:
  // all go to `out`, as one object a line; docs/options.md has the schema.
  // `columns`: width of the terminal; unused elsewhere.
  ProgressLine(std::ostream* out,
               std::ostream* err,
               bool terminal,
               int columns,
               Clock clock,
               bool json = false);
  ~ProgressLine() { Close(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // All may be called from any thread.
  void Log(LogLevel level, const std::string& message);
  void Update(const ProgressEvent& event);
  // The options of the run, an object with a member for each.
  void Options(const nlohmann::json& options);
  // As JSON only: what a run that came to its end has done.
  void Result(nlohmann::json members);
  // Takes the line off the terminal; a later Update() brings it back.
  void Close();

 private:
  std::string Render(const ProgressEvent& event, double now) const;
  void Erase();
  void Draw();
  void WriteJson(nlohmann::json object);

  std::mutex mutex_;
  std::ostream* out_;
  std::ostream* err_;
  const bool json_;
  const bool terminal_;
  const int columns_;
  const Clock clock_;
  EtaEstimator eta_;
  std::string line_;   // on the terminal now
  std::string stage_;  // of the last plain line
  double last_plain_time_ = 0;
  const double start_time_;
};

}  // namespace hpm
