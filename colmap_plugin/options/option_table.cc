#include "colmap_plugin/options/option_table.h"

#include "colmap_plugin/options/quality.h"
#include "colmap_plugin/options/shard_number.h"
#include "src/core/limits.h"
#include "src/engine/method.h"

#include <utility>

namespace hpm {
namespace {

constexpr OptionGroup kCommon = OptionGroup::kCommon;
constexpr OptionGroup kColmap = OptionGroup::kColmap;
constexpr OptionGroup kExpert = OptionGroup::kExpert;

constexpr Concerns kAllStages = Concerns::kAllStages;
constexpr Concerns kGeometricStages = Concerns::kGeometricStages;
constexpr Concerns kFinalStage = Concerns::kFinalStage;
constexpr Concerns kPasses = Concerns::kPasses;
constexpr Concerns kInputs = Concerns::kInputs;
constexpr Concerns kOtherOptions = Concerns::kOtherOptions;
constexpr Concerns kRounding = Concerns::kRounding;
constexpr Concerns kNothing = Concerns::kNothing;

// Far beyond what is of use, and far below what overflows or fills the memory.
constexpr int kMaxThreads = 1024;
constexpr int kMaxGpuImages = 64;
constexpr int kMaxIterations = 10000;
constexpr int kMaxPasses = 100;

// One row; `select` maps ToolOptions* to a pointer to the member.
template <class Select>
OptionSpec Row(OptionGroup group,
               Concerns concerns,
               std::string name,
               Select select,
               Allowed allowed,
               std::string help,
               std::string no_effect = "") {
  return {
      group,
      concerns,
      std::move(name),
      [select](ToolOptions* options) { return OptionMember(select(options)); },
      std::move(allowed),
      std::move(help),
      std::move(no_effect)};
}

// A row of one of the structs in ControllerOptions; the name on the command
// line is prefix + name.
template <class Struct>
struct RowsOf {
  const char* prefix;
  Struct ControllerOptions::*where;

  template <class T, class... Rest>
  OptionSpec operator()(OptionGroup group,
                        Concerns concerns,
                        const std::string& name,
                        T Struct::*member,
                        Rest... rest) const {
    return Row(
        group,
        concerns,
        prefix + name,
        [struct_member = where, member](ToolOptions* options) {
          return &(options->controller.*struct_member.*member);
        },
        std::move(rest)...);
  }
};

template <class T>
OptionSpec Log(const std::string& name,
               T LogOptions::*member,
               std::string help) {
  return Row(
      kExpert,
      kNothing,
      name,
      [member](ToolOptions* options) { return &(options->log.*member); },
      Anything(),
      std::move(help),
      "messages go to standard output, warnings and errors to standard error");
}

// One seed with COLMAP's two names for it.
OptionSpec Seed(const std::string& name, std::string help) {
  return Row(
      kColmap,
      kAllStages,
      name,
      [](ToolOptions* options) { return &options->controller.random_seed; },
      Anything(),
      std::move(help));
}

Allowed AnyShard() {
  return {"i/n with 0 <= i < n <= 100000",
          [](const OptionMember& member) {
            return ParseShard(*std::get<std::string*>(member)).has_value();
          },
          {}};
}

std::vector<OptionSpec> MakeTable() {
  using P = PatchMatchStereoOptions;
  using H = HpmOptions;
  using W = WorkspaceOptions;
  using I = ProblemOptions;
  using C = ControllerOptions;
  const RowsOf<P> Stereo = {"PatchMatchStereo.", &C::patch_match};
  const RowsOf<H> Hpm = {"Hpm.", &C::hpm};
  const RowsOf<W> Workspace = {"", &C::workspace};
  const RowsOf<I> HpmProblems = {"Hpm.", &C::problems};
  const RowsOf<W> HpmWorkspace = {"Hpm.", &C::workspace};
  const RowsOf<W> StereoWorkspace = {"PatchMatchStereo.", &C::workspace};
  const RowsOf<I> Problems = {"", &C::problems};
  const RowsOf<I> StereoProblems = {"PatchMatchStereo.", &C::problems};
  const char* const kDepthRule =
      "both depth_min and depth_max -1, or 0 <= depth_min <= depth_max";
  return {
      // A table reads better packed.
      // clang-format off
      // What most runs set.
      Workspace(kCommon, kInputs, "workspace_path", &W::path, Anything(),
                "Folder with images/, sparse/ and stereo/, as image_undistorter leaves it"),
      StereoWorkspace(kCommon, kInputs, "max_image_size", &W::max_image_size, Anything(),
             "Longest image side in pixels; larger images are shrunk; <= 0: no limit"),
      Stereo(kCommon, kPasses, "geom_consistency", &P::geom_consistency, Anything(),
             "Add the geometric passes, which make depths agree between images and find surfaces with "
             "little texture, and write *.geometric.bin; 0: only *.photometric.bin, for a quick look: "
             "less dense, with many more gross errors"),
      Hpm(kCommon, kAllStages, "method", &H::method, OneOf(MethodNames()),
          "hpm_plus: the default, made to be at least as good as the others on every scene; hpm, "
          "hpm_fast: HPM-MVS as published; the others are rows of the paper's ablation (docs/ablation.md)"),
      Hpm(kCommon, kOtherOptions, "quality", &H::quality, OneOf(QualityNames()),
          "Effort of hpm_plus: sets Hpm.num_iterations, num_geom_passes, num_fine_iterations and "
          "num_fine_geom_passes where they are not given (docs/benchmarks.md)"),
      Hpm(kCommon, kNothing, "overwrite", &H::overwrite, Anything(),
          "Compute maps again that are complete and made with the same options"),
      Hpm(kCommon, kNothing, "keep_photometric", &H::keep_photometric, Anything(),
          "0: do not publish *.photometric.bin beside *.geometric.bin, which saves half of the disk; with "
          "PatchMatchStereo.geom_consistency 0 they are the result and stay; those of earlier runs stay, too"),
      Hpm(kCommon, kNothing, "log_format", &H::log_format, OneOf({"text", "json"}),
          "json: patch_match_stereo writes one object a line to standard output, for programs (docs/options.md)"),
      Hpm(kCommon, kNothing, "report", &H::report, Anything(),
          "Write stereo/report.html at the end: pictures, losses and times of all images, warnings with remedies"),
      Hpm(kExpert, kNothing, "shard", &H::shard, AnyShard(),
          "Work only on part i of the images, divided by what they overlap with into n; other processes do the others "
          "(docs/cluster.md)"),
      Hpm(kExpert, kNothing, "stage", &H::stage, Anything(),
          "Work only on this stage; its maps of the stage before must be there (exit 8 if not). `hpm_mvs status` names "
          "the stages; finish: computes nothing, removes what only other stages needed"),
      Hpm(kCommon, kNothing, "confidence", &H::confidence, Anything(),
          "Write stereo/confidence_maps: per pixel the probability, 0 to 1, that its depth is within 1 % of the truth "
          "(docs/confidence.md); asked for when the maps are finished, it takes nearly a whole run"),
      Hpm(kCommon, kNothing, "previews", &H::previews, Anything(),
          "Write colour pictures of the maps to stereo/previews"),
      HpmProblems(kCommon, kInputs, "depth_ranges", &I::depth_ranges, Anything(),
                "File with lines IMAGE NEAR FAR: depth ranges of single images in model units, which go before depth_min "
                "and depth_max; nothing outside is published. Lines that begin with # count for nothing"),
      HpmWorkspace(kCommon, kInputs, "mask_path", &W::mask_path, Anything(),
                "Folder with masks of the undistorted images: of a/b.jpg the mask is a/b.jpg.png, as in COLMAP; where it "
                "is 0 the image is ignored, as reference and as source; leave a margin of half a window around what is wanted, "
                "since windows that reach over the edge see black there"),
      Stereo(kCommon, kNothing, "num_threads", &P::num_threads, Between(-1, kMaxThreads),
             "Threads to use; -1 or 0: all cores"),
      Hpm(kCommon, kRounding, "device", &H::device, OneOf({"auto", "cpu", "cuda"}),
          "auto: GPUs that pass a self-test, else the CPU; cuda: GPUs or an error"),
      Stereo(kCommon, kNothing, "gpu_index", &P::gpu_index, IndexList(),
             "GPUs to use: -1 all, or a list as 0,1; a GPU named twice gets twice the images"),
      Stereo(kCommon, kNothing, "cache_size", &P::cache_size, Above(0), "Memory for images and maps in GiB, at most; what the images at work need is enough"),
      Row(kCommon, kNothing, "project_path", [](ToolOptions* o) { return &o->project_path; }, Anything(),
          "Read all options from this ini file; the rest of the command line is then ignored"),

      // COLMAP's other options, in COLMAP's order.
      Workspace(kColmap, kInputs, "workspace_format", &W::format, OneOfAnyCase({"COLMAP", "PMVS"}),
                "Layout of the workspace"),
      Workspace(kColmap, kInputs, "pmvs_option_name", &W::pmvs_option_name, Anything(),
                "Option file of a PMVS workspace"),
      Problems(kColmap, kInputs, "config_path", &I::config_path, Anything(),
               "Read this file in place of the workspace's patch-match.cfg"),
      Seed("random_seed", "Same seed, options and CPU target: same bytes (COLMAP up to 3.12)"),
      Seed("default_random_seed", "The same as random_seed (COLMAP 3.13 and later)"),
      StereoProblems(kColmap, kInputs, "depth_min", &I::depth_min, CheckedTogether(kDepthRule),
             "Near end of the depth range in model units; nothing outside is published; -1: from the "
             "sparse points, with some slack"),
      StereoProblems(kColmap, kInputs, "depth_max", &I::depth_max, CheckedTogether(kDepthRule),
             "Far end of the depth range"),
      Stereo(kColmap, kAllStages, "window_radius", &P::window_radius, Between(1, 32),
             "Half side of the matching window in pixels"),
      Stereo(kColmap, kAllStages, "sigma_spatial", &P::sigma_spatial, Anything(),
             "Spatial spread of the window weights in pixels; <= 0: window_radius"),
      Stereo(kColmap, kAllStages, "num_samples", &P::num_samples, Above(0),
             "Monte-Carlo draws when source views are chosen for a pixel"),
      StereoProblems(kColmap, kInputs, "min_triangulation_angle", &I::min_triangulation_angle, BetweenBelow(0, 180),
             "Smallest angle in degrees between a reference and an automatic source image"),
      Stereo(kColmap, kOtherOptions, "geom_consistency_regularizer", &P::geom_consistency_regularizer, AtLeast(0),
             "When given, sets Hpm.geom_weight unless that is given too"),
      Stereo(kColmap, kOtherOptions, "geom_consistency_max_cost", &P::geom_consistency_max_cost, AtLeast(0),
             "When given, sets Hpm.geom_max_error unless that is given too"),
      Stereo(kColmap, kFinalStage, "filter", &P::filter, Anything(),
             "Remove pixels that too few source images confirm"),
      Stereo(kColmap, kFinalStage, "filter_min_ncc", &P::filter_min_ncc, Between(-1, 1),
             "Smallest correlation at which a source image confirms a pixel"),
      Stereo(kColmap, kFinalStage, "filter_min_triangulation_angle", &P::filter_min_triangulation_angle,
             Between(0, 180), "Smallest angle in degrees at which a source image confirms a pixel"),
      Stereo(kColmap, kFinalStage, "filter_min_num_consistent", &P::filter_min_num_consistent, AtLeast(0),
             "Source images that must confirm a pixel"),
      Stereo(kColmap, kFinalStage, "filter_geom_consistency_max_cost", &P::filter_geom_consistency_max_cost,
             AtLeast(0), "Largest forward-backward reprojection error in pixels of a confirmation"),
      Stereo(kColmap, kNothing, "write_consistency_graph", &P::write_consistency_graph, Anything(),
             "Also write stereo/consistency_graphs"),

      // Fine tuning, and what has no meaning in this method.
      Hpm(kExpert, kNothing, "gpu_images", &H::gpu_images, Between(-1, kMaxGpuImages),
          "Images in flight per entry of gpu_index; -1 or 0: half as many as threads, shared by the entries, 3 to 8 each, or fewer if memory is short"),
      Hpm(kExpert, kRounding, "cpu_target", &H::cpu_target, Anything(),
          "SIMD instructions to use: auto, scalar, or a target of this machine"),
      Hpm(kExpert, kPasses, "num_iterations", &H::num_iterations, Between(-1, kMaxIterations),
          "Red/black iterations of a photometric or prior pass; -1 or 0: the method's own"),
      Hpm(kExpert, kPasses, "num_geom_iterations", &H::num_geom_iterations, Between(-1, kMaxIterations),
          "Red/black iterations of a geometric pass; -1 or 0: the method's own"),
      Hpm(kExpert, kPasses, "num_geom_passes", &H::num_geom_passes, Between(-1, kMaxPasses),
          "Geometric passes; -1 or 0: the method's own"),
      Hpm(kExpert, kPasses, "num_fine_iterations", &H::num_fine_iterations, Between(-1, kMaxIterations),
          "Iterations of hpm_plus at levels finer than the coarsest; each visits half of the pixels; -1: its own"),
      Hpm(kExpert, kPasses, "num_fine_geom_passes", &H::num_fine_geom_passes, Between(-1, kMaxPasses),
          "Hpm.num_geom_passes of hpm_plus at levels finer than the coarsest; -1 or 0: its own"),
      Hpm(kExpert, kAllStages, "max_views", &H::max_views, Between(-1, kMaxViews),
          "Source images that judge a pixel at a time, chosen anew in every iteration; -1 or 0: the method's own"),
      Hpm(kExpert, kAllStages, "weak_gradient", &H::weak_gradient, AtLeast(0),
          "Grey levels per pixel under which a region counts as untextured (hpm_plus)"),
      Hpm(kExpert, kGeometricStages, "geom_weight", &H::geom_weight, AtLeast(0),
          "Weight of the geometric term per pixel of reprojection error"),
      Hpm(kExpert, kGeometricStages, "geom_max_error", &H::geom_max_error, AtLeast(0),
          "Cap of the reprojection error in the geometric term, in pixels"),
      Hpm(kExpert, kPasses, "num_levels", &H::num_levels, Between(-1, 8),
          "Levels of the prior hierarchy or image pyramid; -1 or 0: by method and image size"),
      Hpm(kExpert, kFinalStage, "filter_min_agreement", &H::filter_min_agreement, Between(0, 1),
          "Share of the source images that see a plain surface which nothing explains, as a sky, that must confirm it "
          "(hpm_plus); 0: filter_min_num_consistent alone, keeps more of walls and of skies"),
      Stereo(kExpert, kNothing, "allow_missing_files", &P::allow_missing_files, Anything(),
             "Leave out source images whose files are missing",
             "source images without a file are left out in any case, with a warning"),
      Stereo(kExpert, kNothing, "window_step", &P::window_step, Between(1, 2), "Pixel stride in the window",
             "the stride of the window is part of the method"),
      Stereo(kExpert, kNothing, "sigma_color", &P::sigma_color, Above(0),
             "Colour spread of COLMAP's window weights", "the colour spread is part of the method"),
      Stereo(kExpert, kNothing, "ncc_sigma", &P::ncc_sigma, Above(0), "Spread of COLMAP's NCC likelihood",
             "source views are weighted in another way"),
      Stereo(kExpert, kNothing, "incident_angle_sigma", &P::incident_angle_sigma, Above(0),
             "Spread of COLMAP's incident angle prior", "source views are weighted in another way"),
      Stereo(kExpert, kNothing, "num_iterations", &P::num_iterations, Above(0),
             "Iterations of COLMAP's sweeps",
             "COLMAP counts sweeps of another scheme; use Hpm.num_iterations"),
      Log("log_to_stderr", &LogOptions::log_to_stderr, "Log switch of COLMAP up to 3.13"),
      Log("log_target", &LogOptions::log_target, "Log target of COLMAP 4.0 and later"),
      Log("log_path", &LogOptions::log_path, "Log file of COLMAP 4.0 and later"),
      Log("log_level", &LogOptions::log_level, "Log level of COLMAP"),
      Log("log_severity", &LogOptions::log_severity, "Log severity of COLMAP 4.0 and later"),
      Log("log_color", &LogOptions::log_color, "Log colours of COLMAP 4.0 and later"),
      // clang-format on
  };
}

}  // namespace

const std::vector<OptionSpec>& OptionTable() {
  static const std::vector<OptionSpec> table = MakeTable();
  return table;
}

const OptionSpec* FindOption(std::string_view name) {
  for (const OptionSpec& option : OptionTable()) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

std::string DefaultText(const OptionSpec& option) {
  ToolOptions defaults;
  return FormatValue(option.member(&defaults));
}

std::string TypeText(const OptionSpec& option) {
  ToolOptions defaults;
  return TypeName(option.member(&defaults));
}

std::string AllowedText(const OptionSpec& option) {
  std::string type = TypeText(option);
  if (type == "bool") return "0/1, true/false, yes/no or on/off";
  if (option.allowed.text.empty()) return type;
  // Names say themselves that they are text.
  return type == "string" ? option.allowed.text
                          : type + ", " + option.allowed.text;
}

std::string ConcernsText(const OptionSpec& option) {
  switch (option.concerns) {
    case kAllStages:
      return "all stages";
    case kGeometricStages:
      return "geometric stages";
    case kFinalStage:
      return "the last stage";
    case kPasses:
      return "stages whose passes change";
    case kInputs:
      return "images whose inputs change";
    case kOtherOptions:
      return "as the options it sets";
    case kRounding:
    case kNothing:
      break;
  }
  return "nothing";
}

}  // namespace hpm
