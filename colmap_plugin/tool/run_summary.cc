#include "colmap_plugin/tool/run_summary.h"

#include "colmap_plugin/tool/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hpm {
namespace {

// Points of fusion must be seen by --StereoFusion.min_num_pixels images, 5 by
// default, of which few images leave little or nothing. 0: the default will do.
int MinNumPixels(int num_images) {
  if (num_images < 1 || num_images > 5) return 0;
  return num_images <= 2 ? num_images : num_images - 1;
}

std::string FusionCommand(const ControllerOptions& options,
                          const RunSummary& summary) {
  const WorkspaceOptions& workspace = options.workspace;
  std::string command = "colmap stereo_fusion --workspace_path " +
                        ShellWord(workspace.path.string());
  if (IsPmvs(workspace)) {
    command += " --workspace_format PMVS --pmvs_option_name " +
               ShellWord(workspace.pmvs_option_name);
  }
  command += options.patch_match.geom_consistency ? " --input_type geometric"
                                                  : " --input_type photometric";
  command +=
      " --output_path " + ShellWord((workspace.path / "fused.ply").string());
  const int min_num_pixels = MinNumPixels(summary.num_fusable);
  if (min_num_pixels > 0)
    command += fmt::format(" --StereoFusion.min_num_pixels {}", min_num_pixels);
  return command;
}

// Empty if nothing worth a line was lost.
std::string LossesLine(const FilterLosses& losses) {
  constexpr double kTooLittle = 0.0005;
  std::vector<std::string> parts;
  for (const auto& [criterion, share] : losses) {
    if (share < kTooLittle) continue;
    parts.push_back(fmt::format("{} {:.1f} %", NameOf(criterion), 100 * share));
  }
  if (parts.empty()) return "";
  return fmt::format("Pixels dropped by: {}", fmt::join(parts, ", "));
}

}  // namespace

std::vector<std::string> SummaryLines(const ControllerOptions& options,
                                      const RunSummary& summary) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format(
      "{} images: {} computed, {} kept from an earlier run, {} failed",
      summary.num_problems,
      summary.num_computed,
      summary.num_kept,
      summary.failed.size()));
  if (summary.valid_pixel_share) {
    lines.push_back(
        fmt::format("Pixels with a depth{}: {:.1f} %",
                    summary.num_kept > 0 ? ", of the images computed now" : "",
                    100 * *summary.valid_pixel_share));
    const std::string losses = LossesLine(summary.filter_losses);
    if (!losses.empty()) lines.push_back(losses);
  }
  lines.push_back(
      fmt::format("Time {}, peak memory {:.2f} GiB{}",
                  FormatDuration(summary.seconds),
                  static_cast<double>(summary.peak_memory_bytes) / (1 << 30),
                  summary.backend.empty() ? "" : ", " + summary.backend));
  const WorkspaceOptions& workspace = options.workspace;
  const std::filesystem::path stereo = StereoPath(workspace);
  lines.push_back(fmt::format("Maps: {} and {}",
                              (stereo / "depth_maps").string(),
                              (stereo / "normal_maps").string()));
  if (summary.fusion_finds_nothing) {
    lines.emplace_back(
        "Next: triangulate sparse points with the known poses; before that "
        "colmap stereo_fusion finds nothing in common between the images (see "
        "the warning). hpm_mvs export --format ply shows each map by itself");
    return lines;
  }
  if (MinNumPixels(summary.num_fusable) > 0) {
    lines.push_back(fmt::format(
        "{} images with maps: fusion wants every point seen in 5 unless told "
        "otherwise",
        summary.num_fusable));
  }
  lines.push_back("Next: " + FusionCommand(options, summary));
  return lines;
}

}  // namespace hpm
