#include "colmap_plugin/workspace/stamp.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/image_name.h"

#include <fstream>

namespace hpm {
namespace {

// Far above any stamp; a larger file is not ours.
constexpr size_t kMaxStampBytes = 1 << 20;

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
                const std::string& fingerprint,
                const nlohmann::json& statistics) {
  nlohmann::json stamp = nlohmann::json::object();
  if (statistics.is_object()) stamp = statistics;
  stamp["fingerprint"] = fingerprint;
  // No newline at the end: the closing brace is the last byte, so every proper
  // prefix of a stamp is recognised as damaged.
  WriteFileAtomically(
      StampPath(state_path, image_name, stage),
      stamp.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void RemoveStamp(const std::filesystem::path& state_path,
                 const std::string& image_name,
                 const std::string& stage) {
  std::error_code ignored;  // absent is as good
  std::filesystem::remove(StampPath(state_path, image_name, stage), ignored);
}

std::optional<std::string> ReadStampFingerprint(
    const std::filesystem::path& state_path,
    const std::string& image_name,
    const std::string& stage) {
  const std::filesystem::path path = StampPath(state_path, image_name, stage);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  const auto num_bytes = std::filesystem::file_size(path, error);
  if (error || num_bytes >= kMaxStampBytes) return std::nullopt;
  std::string text(num_bytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(file.gcount()));

  const nlohmann::json stamp =
      nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!stamp.is_object()) return std::nullopt;
  const auto fingerprint = stamp.find("fingerprint");
  if (fingerprint == stamp.end() || !fingerprint->is_string())
    return std::nullopt;
  return fingerprint->get<std::string>();
}

}  // namespace hpm
