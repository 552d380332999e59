#include "colmap_plugin/workspace/lock_owner.h"

#include "src/base/platform/processes.h"

#include <cstdlib>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hpm {
namespace {

// What Slurm, Kubernetes' Indexed Jobs, PBS and LSF tell their tasks.
std::string JobOfThisProcess() {
  std::string job;
  for (const char* name : {"SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && job.empty()) job = value;
  }
  for (const char* name : {"SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"}) {
    const char* value = std::getenv(name);
    if (value != nullptr) job += (job.empty() ? "" : "_") + std::string(value);
  }
  return job;
}

std::string RandomToken() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

}  // namespace

LockOwner ThisProcess() {
  LockOwner owner;
  owner.host = HostName();
  owner.boot_id = BootId();
  owner.pid_namespace = ProcessNamespace();
  owner.pid = ThisProcessId();
  owner.start_time = StatusOfProcess(owner.pid).start_time;
  owner.job = JobOfThisProcess();
  owner.token = RandomToken();
  return owner;
}

std::string FormatLockOwner(const LockOwner& owner) {
  const nlohmann::json json = {{"host", owner.host},
                               {"boot_id", owner.boot_id},
                               {"pid_namespace", owner.pid_namespace},
                               {"pid", owner.pid},
                               {"start_time", owner.start_time},
                               {"job", owner.job},
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
  if (owner.pid <= 0 || owner.pid > std::numeric_limits<int32_t>::max())
    return std::nullopt;
  if (has("boot_id", &nlohmann::json::is_string))
    owner.boot_id = json["boot_id"];
  if (has("job", &nlohmann::json::is_string)) owner.job = json["job"];
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
  const ProcessStatus status = StatusOfProcess(owner.pid);
  return status.state == ProcessState::kAlive &&
         (owner.start_time == 0 || status.start_time == 0 ||
          owner.start_time == status.start_time);
}

}  // namespace hpm
