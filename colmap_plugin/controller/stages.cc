#include "colmap_plugin/controller/stages.h"

#include "colmap_plugin/controller/method_options.h"
#include "colmap_plugin/formats/consistency_graph.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/fingerprint.h"
#include "colmap_plugin/workspace/source_level.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"

#include <algorithm>
#include <system_error>

namespace hpm {
namespace {

// Raise when the same options give other maps.
constexpr int kAlgorithmVersion = 9;

constexpr const char* kLevelPrefix = "level_";
constexpr const char* kGeometricPrefix = "geometric_";
constexpr const char* kSourcePrefix = "source_";

bool StartsWith(const std::string& text, const char* prefix) {
  return text.rfind(prefix, 0) == 0;
}

std::vector<Stage> MakeStages(const Schedule& schedule) {
  std::vector<Stage> stages;
  int num_geometric = 0;
  for (const StageSpec& spec : schedule.stages) {
    Stage stage;
    stage.spec = spec;
    if (spec.level > 0) {
      stage.name = kLevelPrefix + std::to_string(spec.level) + "_";
    }
    if (spec.geometric) {
      stage.name += kGeometricPrefix + std::to_string(++num_geometric);
    } else {
      num_geometric = 0;
      stage.name += "photometric";
      stage.is_public = spec.level == 0;
    }
    stages.push_back(stage);
  }
  Stage& last = stages.back();
  last.is_public = true;
  last.is_final = true;
  if (last.spec.geometric) last.name = "geometric";
  return stages;
}

// The pose as the reference sees it.
void AddImage(const Workspace& workspace,
              int image,
              int ref_image,
              Fingerprint* hash) {
  const Camera camera = workspace.CameraAround(image, ref_image);
  std::error_code error;
  const auto num_bytes =
      std::filesystem::file_size(workspace.ImagePath(image), error);
  hash->AddString(workspace.ImageName(image))
      .AddInt(error ? -1 : static_cast<int64_t>(num_bytes));
  hash->AddInt(camera.width).AddInt(camera.height);
  for (const float v : {camera.fx, camera.fy, camera.cx, camera.cy})
    hash->AddDouble(v);
  for (const float v : camera.R.m) hash->AddDouble(v);
  for (const float v : {camera.t.x, camera.t.y, camera.t.z}) hash->AddDouble(v);
  const ImageDecoding decoding = workspace.Decoding(image);
  if (decoding.stretch) {
    hash->AddString("stretched")
        .AddDouble(decoding.stretch->low)
        .AddDouble(decoding.stretch->high);
  }
  if (decoding.reduction > 1)
    hash->AddString("decoded at").AddInt(decoding.reduction);
}

void AddMethod(const MethodParams& params, Fingerprint* hash) {
  hash->AddInt(params.patch_radius)
      .AddInt(params.num_view_draws)
      .AddInt(params.max_drawn_views);
  for (const float v : {params.sigma_spatial,
                        params.sigma_color,
                        params.cut_color,
                        params.depth_perturbation,
                        params.normal_perturbation,
                        params.same_plane_bound,
                        params.worst_cost,
                        params.prior_gamma,
                        params.prior_beta,
                        params.prior_depth_share,
                        params.prior_angle}) {
    hash->AddDouble(v);
  }
}

void AddFilter(const PatchMatchStereoOptions& options, Fingerprint* hash) {
  hash->AddInt(options.filter);
  if (!options.filter) return;
  hash->AddDouble(options.filter_min_ncc)
      .AddDouble(options.filter_min_triangulation_angle);
  hash->AddInt(options.filter_min_num_consistent);
  hash->AddDouble(options.filter_geom_consistency_max_cost);
}

// What a stage of a problem depends on beside the stage before.
std::string OwnFingerprint(const Workspace& workspace,
                           const StereoProblem& problem,
                           const Stage& stage,
                           const ControllerOptions& options) {
  Fingerprint hash;
  hash.AddInt(kAlgorithmVersion)
      .AddString(stage.name)
      .AddInt(options.random_seed);
  AddImage(workspace, problem.ref_image, problem.ref_image, &hash);
  for (const int src : problem.src_images) {
    AddImage(workspace, src, problem.ref_image, &hash);
    const int level = SourceLevel(workspace, problem, src);
    if (level > 0) hash.AddString("halved").AddInt(level);
  }
  hash.AddDouble(problem.depth_min).AddDouble(problem.depth_max);
  const MethodParams params = MakeMethodParams(options);
  AddMethod(params, &hash);
  hash.AddString(options.hpm.method);
  for (const Pass& pass : stage.spec.passes) {
    hash.AddInt(static_cast<int>(pass.kind)).AddInt(pass.num_iterations);
    hash.AddInt(pass.id).AddInt(pass.level);
    hash.AddInt(pass.max_candidates).AddInt(pass.max_drawn_views);
    hash.AddInt(pass.half).AddInt(pass.few_views).AddInt(pass.fit_planes);
    hash.AddInt(pass.ask_all_views).AddInt(pass.search_near);
    hash.AddInt(static_cast<int>(pass.start));
    hash.AddInt(static_cast<int>(pass.regions));
    if (pass.start == StartFrom::kMissing)
      hash.AddDouble(params.region_max_gradient);
  }
  if (stage.spec.geometric) {
    hash.AddDouble(params.geom_weight).AddDouble(params.geom_max_error);
    hash.AddDouble(params.region_max_gradient);
  }
  if (stage.is_final) {
    AddFilter(options.patch_match, &hash);
    hash.AddDouble(problem.published.min).AddDouble(problem.published.max);
  }
  return hash.Hex();
}

}  // namespace

std::string NameForSources(const Stage& stage) {
  return kSourcePrefix + stage.name;
}

StagePlan::StagePlan(const Workspace& workspace,
                     const std::vector<StereoProblem>& problems,
                     const Schedule& schedule,
                     const ControllerOptions& options)
    : workspace_(workspace),
      problems_(problems),
      options_(options),
      stages_(MakeStages(schedule)) {
  Update();
}

void StagePlan::Update() {
  const std::vector<StereoProblem>& problems = problems_;
  const int num_stages = static_cast<int>(stages_.size());
  const int num_problems = static_cast<int>(problems.size());
  problem_of_image_.assign(workspace_.num_images(), -1);
  for (int p = 0; p < num_problems; ++p)
    problem_of_image_[problems[p].ref_image] = p;

  fingerprints_.clear();
  found_foreign_maps_ = false;
  for (int s = 0; s < num_stages; ++s) {
    fingerprints_.emplace_back();
    for (int p = 0; p < num_problems; ++p) {
      Fingerprint hash;
      hash.AddString(
          OwnFingerprint(workspace_, problems[p], stages_[s], options_));
      if (s > 0) {
        hash.AddString(fingerprints_[s - 1][p]);
        for (const int src : problems[p].src_images) {
          if (!stages_[s].spec.geometric) break;
          const int q = problem_of_image_[src];
          hash.AddString(q < 0 ? "" : fingerprints_[s - 1][q]);
        }
      }
      fingerprints_[s].push_back(hash.Hex());
    }
  }

  // Backwards: the maps COLMAP's users see must be finished; those of inner
  // passes only if the pass after them still has to read them.
  needed_.assign(num_stages, std::vector<bool>(num_problems, false));
  for (int s = num_stages - 1; s >= 0; --s) {
    std::vector<bool> wanted(num_problems);  // by the stage after
    for (int q = 0; q < num_problems; ++q) {
      if (s + 1 == num_stages || !needed_[s + 1][q]) continue;
      wanted[q] = true;
      if (!stages_[s + 1].spec.geometric) continue;
      for (const int src : problems[q].src_images) {
        if (problem_of_image_[src] >= 0) wanted[problem_of_image_[src]] = true;
      }
    }
    for (int p = 0; p < num_problems; ++p) {
      if (!CanBeComputed(workspace_, problems[p]) ||
          (!wanted[p] && !IsPublic(s, problems[p].ref_image))) {
        continue;
      }
      needed_[s][p] = options_.hpm.overwrite || !IsFinished(s, p, !wanted[p]);
    }
  }
  replaces_foreign_maps_ = replaces_foreign_maps_ && found_foreign_maps_;
}

int StagePlan::CountNeeded(int s) const {
  return static_cast<int>(
      std::count(needed_[s].begin(), needed_[s].end(), true));
}

std::string StagePlan::CutFingerprintOf(int s, int p) const {
  Fingerprint hash;
  hash.AddString(fingerprints_[s][p])
      .AddDouble(problems_[p].published.min)
      .AddDouble(problems_[p].published.max);
  return hash.Hex() + "-cut";
}

StageFiles StagePlan::Files(int s, int image) const {
  const std::string stage = NameOf(s, image);
  if (IsPublic(s, image)) {
    return {workspace_.MapPath(image, MapKind::kDepth, stage),
            workspace_.MapPath(image, MapKind::kNormal, stage),
            workspace_.MapPath(image, MapKind::kConsistencyGraph, stage)};
  }
  const std::filesystem::path folder = workspace_.StatePath() / stage;
  const std::string& name = workspace_.ImageName(image);
  return {folder / (name + ".depth.bin"), folder / (name + ".normal.bin"), {}};
}

std::optional<std::string> StagePlan::StampOf(int s, int image) const {
  return ReadStampFingerprint(
      workspace_.StatePath(), workspace_.ImageName(image), NameOf(s, image));
}

std::string StagePlan::NameOf(int s, int image) const {
  const int p = problem_of_image_[image];
  return p >= 0 && !problems_[p].is_reference ? NameForSources(stages_[s])
                                              : stages_[s].name;
}

bool StagePlan::IsPublic(int s, int image) const {
  const int p = problem_of_image_[image];
  return stages_[s].is_public && (p < 0 || problems_[p].is_reference);
}

bool StagePlan::HasCompleteMaps(int s, int image) const {
  const int p = problem_of_image_[image];
  return p >= 0 && StampOf(s, image) == fingerprints_[s][p];
}

bool StagePlan::HasCurrentMaps(int s, int image) const {
  const int p = problem_of_image_[image];
  return HasCompleteMaps(s, image) ||
         (p >= 0 && StampOf(s, image) == IncompleteFingerprintOf(s, p));
}

bool StagePlan::WritesGraph(int s, int image) const {
  return options_.patch_match.write_consistency_graph && IsPublic(s, image);
}

bool StagePlan::IsFinished(int s, int p, bool may_be_cut) {
  const int image = problems_[p].ref_image;
  const StageFiles files = Files(s, image);
  std::error_code error;
  if (!std::filesystem::exists(files.depth, error) ||
      !std::filesystem::exists(files.normal, error)) {
    return false;
  }
  if (!HasCompleteMaps(s, image)) {
    const bool is_cut = StampOf(s, image) == CutFingerprintOf(s, p);
    const std::optional<std::string> stamp = StampOf(s, image);
    if (!is_cut && stamp != IncompleteFingerprintOf(s, p))
      found_foreign_maps_ = true;
    if (!is_cut || !may_be_cut) return false;
  }
  const Camera camera = CameraOf(s, image);
  const auto has_size = [&](const MapHeader& header, int channels) {
    return header.width == camera.width && header.height == camera.height &&
           header.channels == channels;
  };
  const auto is_whole = [&](const std::filesystem::path& file, int channels) {
    bool fits = false;
    try {
      fits = has_size(ReadMapHeader(file), channels);
    } catch (const Error&) {
      // Torn or damaged: made anew.
    }
    if (!fits) damaged_maps_.insert(file);
    return fits;
  };
  const bool depth_is_whole = is_whole(files.depth, 1);
  if (!is_whole(files.normal, 3) || !depth_is_whole) return false;
  if (!WritesGraph(s, image)) return true;
  try {
    const ConsistencyGraph graph = ReadConsistencyGraph(files.graph);
    return graph.width == camera.width && graph.height == camera.height;
  } catch (const Error&) {
    return false;
  }
}

void RemoveInnerMaps(const Workspace& workspace) {
  std::error_code error;
  std::vector<std::filesystem::path> folders;
  for (std::filesystem::directory_iterator it(workspace.StatePath(), error),
       end;
       !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    for (const char* prefix : {kLevelPrefix, kGeometricPrefix, kSourcePrefix}) {
      if (StartsWith(name, prefix)) folders.push_back(it->path());
    }
  }
  for (const std::filesystem::path& folder : folders)
    std::filesystem::remove_all(folder, error);
}

}  // namespace hpm
