#include "src/base/platform/processes.h"

#include <cerrno>
#include <csignal>
#include <fstream>
#include <iterator>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>
#include <system_error>

#include <unistd.h>
#ifdef __APPLE__
#include <libproc.h>
#include <mach-o/dyld.h>
#include <sys/sysctl.h>
#endif

namespace hpm {
namespace fs = std::filesystem;
namespace {

#ifdef __APPLE__

std::string SystemText(const char* name) {
  char text[256] = {};
  size_t size = sizeof(text) - 1;
  return sysctlbyname(name, text, &size, nullptr, 0) == 0 ? text : "";
}

std::optional<ProcessStatus> Ask(int64_t id) {
  proc_bsdinfo info = {};
  if (proc_pidinfo(
          static_cast<pid_t>(id), PROC_PIDTBSDINFO, 0, &info, sizeof(info)) !=
      static_cast<int>(sizeof(info))) {
    return std::nullopt;
  }
  ProcessStatus status;
  status.state =
      info.pbi_status == SZOMB ? ProcessState::kEnded : ProcessState::kAlive;
  status.start_time = info.pbi_start_tvsec * 1000000 + info.pbi_start_tvusec;
  return status;
}

#else

// proc(5), /proc/<pid>/stat: fields 3 and 22, counted from behind the command
// name.
std::optional<ProcessStatus> Ask(int64_t id) {
  std::ifstream file("/proc/" + std::to_string(id) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file),
                         std::istreambuf_iterator<char>()};
  const size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(name_end + 1));
  fields.imbue(std::locale::classic());
  char state = '?';
  ProcessStatus status;
  fields >> state;
  std::string skipped;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  fields >> status.start_time;
  if (!fields) return std::nullopt;
  status.state = state == 'Z' || state == 'X' ? ProcessState::kEnded
                                              : ProcessState::kAlive;
  return status;
}

#endif

}  // namespace

int64_t ThisProcessId() { return getpid(); }

fs::path ThisProgram() {
  std::error_code error;
#ifdef __APPLE__
  uint32_t size = 0;
  _NSGetExecutablePath(nullptr, &size);
  std::string name(size, '\0');
  if (_NSGetExecutablePath(name.data(), &size) != 0) return {};
  const fs::path path = fs::canonical(name.c_str(), error);
#else
  const fs::path path = fs::read_symlink("/proc/self/exe", error);
#endif
  return error ? fs::path() : path;
}

int ReplaceThisProgram(const fs::path& program, char** argv) {
  // The found path, as a program may look for its files beside argv[0].
  std::string name = program.string();
  argv[0] = name.data();
  return execv(name.c_str(), argv);
}

bool IsExecutable(const fs::path& path) {
  return access(path.c_str(), X_OK) == 0;
}

std::string HostName() {
  char host[256] = {};
  return gethostname(host, sizeof(host) - 1) == 0 ? host : "";
}

std::string BootId() {
#ifdef __APPLE__
  return SystemText("kern.bootsessionuuid");
#else
  std::string id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
  return id;
#endif
}

std::string ProcessNamespace() {
  std::error_code error;
  return fs::read_symlink("/proc/self/ns/pid", error).string();
}

ProcessStatus StatusOfProcess(int64_t id) {
  // Numbers that are no process, or that kill(2) takes for many.
  if (id <= 0 || id > std::numeric_limits<pid_t>::max()) return {};
  if (kill(static_cast<pid_t>(id), 0) != 0 && errno == ESRCH) return {};
  const std::optional<ProcessStatus> status = Ask(id);
  return status ? *status : ProcessStatus{ProcessState::kAlive, 0};
}

}  // namespace hpm
