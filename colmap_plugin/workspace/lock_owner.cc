#include "colmap_plugin/workspace/lock_owner.h"

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <random>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace hpm {
namespace {

struct ProcessStatus {
  char state = '?';
  uint64_t start_time = 0;
};

// proc(5), /proc/<pid>/stat: fields 3 and 22, counted from behind the command
// name.
std::optional<ProcessStatus> ReadProcessStatus(int64_t pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  const std::string text{std::istreambuf_iterator<char>(file),
                         std::istreambuf_iterator<char>()};
  const size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(name_end + 1));
  fields.imbue(std::locale::classic());
  ProcessStatus status;
  fields >> status.state;
  std::string skipped;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  fields >> status.start_time;
  if (!fields) return std::nullopt;
  return status;
}

std::string RandomToken() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

}  // namespace

LockOwner ThisProcess() {
  LockOwner owner;
  char host[256] = {};
  if (gethostname(host, sizeof(host) - 1) == 0) owner.host = host;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> owner.boot_id;
  std::error_code error;
  owner.pid_namespace =
      std::filesystem::read_symlink("/proc/self/ns/pid", error).string();
  owner.pid = getpid();
  if (const auto status = ReadProcessStatus(owner.pid))
    owner.start_time = status->start_time;
  owner.token = RandomToken();
  return owner;
}

std::string FormatLockOwner(const LockOwner& owner) {
  const nlohmann::json json = {{"host", owner.host},
                               {"boot_id", owner.boot_id},
                               {"pid_namespace", owner.pid_namespace},
                               {"pid", owner.pid},
                               {"start_time", owner.start_time},
                               {"token", owner.token},
                               {"flock", owner.flock},
                               {"heartbeat", owner.heartbeat}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::optional<LockOwner> ParseLockOwner(const std::string& text) {
  const nlohmann::json json =
      nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto has = [&](const char* key,
                       bool (nlohmann::json::*is)() const noexcept) {
    return json.contains(key) && (json[key].*is)();
  };
  if (!json.is_object() || !has("host", &nlohmann::json::is_string) ||
      !has("pid_namespace", &nlohmann::json::is_string) ||
      !has("pid", &nlohmann::json::is_number_unsigned) ||
      !has("start_time", &nlohmann::json::is_number_unsigned)) {
    return std::nullopt;
  }
  LockOwner owner;
  owner.host = json["host"];
  owner.pid_namespace = json["pid_namespace"];
  owner.pid = json["pid"];
  owner.start_time = json["start_time"];
  if (owner.pid <= 0 || owner.pid != static_cast<pid_t>(owner.pid))
    return std::nullopt;
  if (has("boot_id", &nlohmann::json::is_string))
    owner.boot_id = json["boot_id"];
  if (has("token", &nlohmann::json::is_string)) owner.token = json["token"];
  if (has("flock", &nlohmann::json::is_boolean)) owner.flock = json["flock"];
  if (has("heartbeat", &nlohmann::json::is_boolean))
    owner.heartbeat = json["heartbeat"];
  return owner;
}

bool IsVisible(const LockOwner& owner, const LockOwner& self) {
  // Many machines have the same name, and all have the same first name space.
  return owner.host == self.host && owner.pid_namespace == self.pid_namespace &&
         (owner.boot_id.empty() || owner.boot_id == self.boot_id);
}

bool IsAlive(const LockOwner& owner) {
  if (kill(static_cast<pid_t>(owner.pid), 0) != 0 && errno == ESRCH)
    return false;
  const auto status = ReadProcessStatus(owner.pid);
  if (!status) return true;
  if (status->state == 'Z' || status->state == 'X')
    return false;  // dead, not yet waited for
  return owner.start_time == 0 || owner.start_time == status->start_time;
}

}  // namespace hpm
