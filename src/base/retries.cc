#include "src/base/retries.h"

#include <algorithm>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace hpm {
namespace {

// Of the process: files are opened in many places that have neither a log nor a
// token, and disks fail for all of them.
struct Setting {
  LogSink log;
  const CancelToken* cancel = nullptr;
  RetryRules rules;
  int num_told = 0;
};
std::mutex mutex;
// Of the scopes that live, below them that of none.
std::vector<Setting> settings(1);

constexpr int kMaxTold = 10;

void Tell(const std::filesystem::path& path,
          int error,
          std::chrono::milliseconds wait) {
  LogSink log;
  std::string more;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    Setting& setting = settings.back();
    if (!setting.log || setting.num_told == kMaxTold) return;
    if (++setting.num_told == kMaxTold) more = "; further ones are not told";
    log = setting.log;
  }
  log(LogLevel::kWarning,
      fmt::format("{}: {}; trying again in {} s{}",
                  path.string(),
                  std::generic_category().message(error),
                  static_cast<double>(wait.count()) / 1000,
                  more));
}

void Wait(std::chrono::milliseconds time, const CancelToken* cancel) {
  constexpr auto kStep = std::chrono::milliseconds(50);
  for (; time.count() > 0; time -= kStep) {
    if (cancel != nullptr) cancel->ThrowIfCancelled();
    std::this_thread::sleep_for(std::min(time, kStep));
  }
}

// question(&error_code): as the predicates of std::filesystem.
template <class Question>
bool Ask(const std::filesystem::path& path, const Question& question) {
  std::error_code last;
  const bool answer = RetryFileSystem(path, [&](std::error_code& error) {
    const bool is_so = question(error);
    last = error;
    return is_so;
  });
  ThrowIfTransient(ErrnoOf(last), path);
  return answer;
}

}  // namespace

bool IsTransient(int error) {
  return error == EIO || error == ESTALE || error == EAGAIN ||
         error == ETIMEDOUT;
}

void ThrowIfTransient(int error, const std::filesystem::path& path) {
  if (!IsTransient(error)) return;
  throw Error(ErrorCode::kBadInput,
              fmt::format("cannot look at {}: {}; check the disk or its server "
                          "and run again",
                          path.string(),
                          std::generic_category().message(error)));
}

RetryScope::RetryScope(LogSink log,
                       const CancelToken* cancel,
                       RetryRules rules) {
  const std::lock_guard<std::mutex> lock(mutex);
  settings.push_back({std::move(log), cancel, rules, 0});
}

RetryScope::~RetryScope() {
  const std::lock_guard<std::mutex> lock(mutex);
  settings.pop_back();
}

bool Retries::Again(int error) {
  if (error == EINTR) return true;
  if (!IsTransient(error)) return false;
  RetryRules rules;
  const CancelToken* cancel = nullptr;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    rules = settings.back().rules;
    cancel = settings.back().cancel;
  }
  if (num_tries_ == rules.max_tries) return false;
  std::chrono::milliseconds wait = rules.first_wait;
  for (int i = 0; i < num_tries_; ++i) wait *= rules.growth;
  ++num_tries_;
  Tell(path_, error, wait);
  Wait(wait, cancel);
  return true;
}

bool Exists(const std::filesystem::path& path) {
  return Ask(path, [&](std::error_code& error) {
    return std::filesystem::exists(path, error);
  });
}

bool IsFolder(const std::filesystem::path& path) {
  return Ask(path, [&](std::error_code& error) {
    return std::filesystem::is_directory(path, error);
  });
}

bool IsRegularFile(const std::filesystem::path& path) {
  return Ask(path, [&](std::error_code& error) {
    return std::filesystem::is_regular_file(path, error);
  });
}

std::error_code MakeFolder(const std::filesystem::path& path) {
  std::error_code last;
  RetryFileSystem(path, [&](std::error_code& error) {
    std::filesystem::create_directories(path, error);
    // libstdc++ takes a folder above that it cannot look at for one that is
    // there, and then lacks it.
    if (error == std::errc::no_such_file_or_directory)
      std::filesystem::create_directories(path, error);
    last = error;
    return !error;
  });
  return last;
}

}  // namespace hpm
