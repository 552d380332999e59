#include "src/base/platform/processes.h"

#include <cerrno>
#include <vector>

#include <process.h>
#include <windows.h>

namespace hpm {
namespace fs = std::filesystem;

int64_t ThisProcessId() { return GetCurrentProcessId(); }

fs::path ThisProgram() {
  std::wstring name(32768, L'\0');
  const DWORD size =
      GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  name.resize(size < name.size() ? size : 0);
  return name;
}

int ReplaceThisProgram(const fs::path& program, char** argv) {
  // The C library joins the arguments by blanks; each is quoted as its
  // counterpart in the other program takes them apart again.
  const auto quoted = [](const std::string& text) {
    std::string out = "\"";
    size_t num_backslashes = 0;
    for (const char c : text) {
      if (c == '"') out.append(num_backslashes + 1, '\\');
      num_backslashes = c == '\\' ? num_backslashes + 1 : 0;
      out += c;
    }
    return out.append(num_backslashes, '\\') + '"';
  };
  const std::string name = program.string();
  std::vector<std::string> words = {quoted(name)};
  for (char** word = argv + 1; *word != nullptr; ++word)
    words.push_back(quoted(*word));
  std::vector<const char*> arguments;
  for (const std::string& word : words) arguments.push_back(word.c_str());
  arguments.push_back(nullptr);
  return static_cast<int>(_spawnv(_P_WAIT, name.c_str(), arguments.data()));
}

bool IsExecutable(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

std::string HostName() {
  char name[256] = {};
  DWORD size = sizeof(name) - 1;
  return GetComputerNameExA(ComputerNameDnsHostname, name, &size) ? name : "";
}

std::string BootId() { return ""; }

std::string ProcessNamespace() { return ""; }

ProcessStatus StatusOfProcess(int64_t id) {
  if (id <= 0 || id > UINT32_MAX) return {};
  const HANDLE process = OpenProcess(
      PROCESS_QUERY_LIMITED_INFORMATION, FALSE, static_cast<DWORD>(id));
  if (process == nullptr) {
    // Another user's process is one.
    const bool is_there = GetLastError() == ERROR_ACCESS_DENIED;
    return {is_there ? ProcessState::kAlive : ProcessState::kGone, 0};
  }
  ProcessStatus status{ProcessState::kAlive, 0};
  DWORD code = 0;
  if (GetExitCodeProcess(process, &code) && code != STILL_ACTIVE)
    status.state = ProcessState::kEnded;
  FILETIME start = {}, end = {}, kernel = {}, user = {};
  if (GetProcessTimes(process, &start, &end, &kernel, &user)) {
    status.start_time = (static_cast<uint64_t>(start.dwHighDateTime) << 32) |
                        start.dwLowDateTime;
  }
  CloseHandle(process);
  return status;
}

}  // namespace hpm
