#include "colmap_plugin/tool/run_summary.h"

#include "colmap_plugin/tool/text.h"

#include <fmt/format.h>

namespace hpm {
namespace {

bool IsPmvs(const WorkspaceOptions& workspace) {
  return !workspace.format.empty() &&
         (workspace.format[0] == 'P' || workspace.format[0] == 'p');
}

std::string FusionCommand(const ControllerOptions& options) {
  const WorkspaceOptions& workspace = options.workspace;
  std::string command = "colmap stereo_fusion --workspace_path " +
                        ShellWord(workspace.path.string());
  if (IsPmvs(workspace)) {
    command += " --workspace_format PMVS --pmvs_option_name " +
               ShellWord(workspace.pmvs_option_name);
  }
  command += options.patch_match.geom_consistency ? " --input_type geometric"
                                                  : " --input_type photometric";
  return command + " --output_path " +
         ShellWord((workspace.path / "fused.ply").string());
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
  if (summary.num_computed > 0) {
    lines.push_back(fmt::format("Pixels with a depth: {:.1f} %",
                                100 * summary.valid_pixel_share));
  }
  lines.push_back(
      fmt::format("Time {}, peak memory {:.2f} GiB{}",
                  FormatDuration(summary.seconds),
                  static_cast<double>(summary.peak_memory_bytes) / (1 << 30),
                  summary.cpu_target.empty() ? "" : ", " + summary.cpu_target));
  const WorkspaceOptions& workspace = options.workspace;
  const std::filesystem::path stereo =
      workspace.path / (IsPmvs(workspace)
                            ? "stereo-" + workspace.pmvs_option_name
                            : std::string("stereo"));
  lines.push_back(fmt::format("Maps: {} and {}",
                              (stereo / "depth_maps").string(),
                              (stereo / "normal_maps").string()));
  lines.push_back("Next: " + FusionCommand(options));
  return lines;
}

}  // namespace hpm
