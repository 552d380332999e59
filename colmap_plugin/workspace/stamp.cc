#include "colmap_plugin/workspace/stamp.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/image_name.h"
#include "src/base/error.h"
#include "src/base/input_file.h"
#include "src/base/platform/files.h"

#include <utility>

namespace hpm {
namespace {

// Far above any stamp; a larger file is not ours.
constexpr size_t kMaxStampBytes = 1 << 20;

// Raise when stamps vouch for more, or in another way, than they did.
constexpr int kStampVersion = 2;

nlohmann::json ToJson(const PublishedFile& file) {
  return {{"bytes", file.state.num_bytes},
          {"time_ns", file.state.time_ns},
          {"xxh3", file.checksum}};
}

std::optional<PublishedFile> FileFrom(const nlohmann::json& json) {
  if (!json.is_object()) return std::nullopt;
  const auto bytes = json.find("bytes");
  const auto time = json.find("time_ns");
  const auto checksum = json.find("xxh3");
  if (bytes == json.end() || !bytes->is_number_integer() ||
      time == json.end() || !time->is_number_integer() ||
      checksum == json.end() || !checksum->is_string()) {
    return std::nullopt;
  }
  return PublishedFile{{bytes->get<uint64_t>(), time->get<int64_t>()},
                       checksum->get<std::string>()};
}

void Sync(const std::filesystem::path& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return;
  SyncFile(fd);
  close(fd);
}

}  // namespace

std::filesystem::path StampPath(const std::filesystem::path& state_path,
                                const std::string& image_name,
                                const std::string& stage) {
  CheckImageName(image_name);
  CheckImageName(stage);
  // The stage is a folder, so that names as long as COLMAP's maps allow fit.
  return state_path / "stamps" / stage / (image_name + ".json");
}

void WriteStamp(const std::filesystem::path& state_path,
                const std::string& image_name,
                const std::string& stage,
                const Stamp& stamp) {
  nlohmann::json json = nlohmann::json::object();
  if (stamp.statistics.is_object()) json = stamp.statistics;
  json["version"] = kStampVersion;
  json["fingerprint"] = stamp.fingerprint;
  json["files"] = nlohmann::json::object();
  for (const auto& [kind, file] : stamp.files)
    json["files"][kind] = ToJson(file);
  if (stamp.unsynced_since) json["unsynced_since"] = *stamp.unsynced_since;
  // No newline at the end: the closing brace is the last byte, so every proper
  // prefix of a stamp is recognised as damaged.
  WriteFileAtomically(
      StampPath(state_path, image_name, stage),
      json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace),
      Durability::kProcess);
}

void SyncStamps(const std::filesystem::path& state_path,
                const std::string& stage) {
  const std::filesystem::path folder =
      StampPath(state_path, "any", stage).parent_path();
  std::error_code error;
  std::filesystem::recursive_directory_iterator it(folder, error);
  for (const std::filesystem::recursive_directory_iterator end;
       !error && it != end;
       it.increment(error)) {
    Sync(it->path());
  }
  Sync(folder);
  Sync(folder.parent_path());
}

void RemoveStamp(const std::filesystem::path& state_path,
                 const std::string& image_name,
                 const std::string& stage) {
  std::error_code ignored;  // absent is as good
  std::filesystem::remove(StampPath(state_path, image_name, stage), ignored);
}

std::optional<Stamp> ReadStamp(const std::filesystem::path& state_path,
                               const std::string& image_name,
                               const std::string& stage) {
  try {
    return ReadStampFile(StampPath(state_path, image_name, stage));
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<Stamp> ReadStampFile(const std::filesystem::path& path) {
  std::string text;
  try {
    text = ReadWholeFile(path, kMaxStampBytes);
  } catch (const UnreadableFile&) {
    throw;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kBadInput) throw;
    return std::nullopt;
  }
  nlohmann::json json =
      nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return std::nullopt;
  const auto version = json.find("version");
  const auto fingerprint = json.find("fingerprint");
  const auto files = json.find("files");
  if (version == json.end() || *version != kStampVersion ||
      fingerprint == json.end() || !fingerprint->is_string() ||
      files == json.end() || !files->is_object()) {
    return std::nullopt;
  }
  Stamp stamp;
  stamp.fingerprint = fingerprint->get<std::string>();
  for (const auto& [kind, entry] : files->items()) {
    const std::optional<PublishedFile> published = FileFrom(entry);
    if (!published) return std::nullopt;
    stamp.files[kind] = *published;
  }
  const auto unsynced = json.find("unsynced_since");
  if (unsynced != json.end())
    stamp.unsynced_since = unsynced->is_string() ? *unsynced : "";
  for (const char* ours : {"version", "fingerprint", "files", "unsynced_since"})
    json.erase(ours);
  stamp.statistics = std::move(json);
  return stamp;
}

}  // namespace hpm
