#include "colmap_plugin/controller/stages.h"

#include "colmap_plugin/controller/stage_fingerprint.h"
#include "colmap_plugin/formats/content_hash.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/file_system.h"
#include "colmap_plugin/workspace/fingerprint.h"
#include "src/base/error.h"
#include "src/base/platform/processes.h"

#include <algorithm>
#include <map>
#include <system_error>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr const char* kLevelPrefix = "level_";
constexpr const char* kGeometricPrefix = "geometric_";
constexpr const char* kSourcePrefix = "source_";
constexpr const char* kPhotometric = "photometric";
constexpr const char* kGeometric = "geometric";

bool StartsWith(const std::string& text, const char* prefix) {
  return text.rfind(prefix, 0) == 0;
}

std::string TitleOf(const StageSpec& spec, int number, int num_stages) {
  std::string size = "full size";
  if (spec.level == 1) size = "half size";
  if (spec.level == 2) size = "quarter size";
  if (spec.level > 2) size = fmt::format("1/{} of the size", 1 << spec.level);
  return fmt::format("{} at {}, pass {} of {}",
                     spec.geometric ? "making images agree" : "searching",
                     size,
                     number,
                     num_stages);
}

std::vector<Stage> MakeStages(const Schedule& schedule, bool keep_photometric) {
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
      stage.name += kPhotometric;
      stage.is_public = spec.level == 0 && keep_photometric;
    }
    stage.title = TitleOf(spec,
                          static_cast<int>(stages.size()) + 1,
                          static_cast<int>(schedule.stages.size()));
    stages.push_back(stage);
  }
  Stage& last = stages.back();
  last.is_public = true;
  last.is_final = true;
  if (last.spec.geometric) last.name = kGeometric;
  return stages;
}

// Empty for a file that cannot be read as what it should be.
std::string ChecksumOf(const std::string& kind,
                       const std::filesystem::path& path,
                       const CancelToken& cancel) {
  try {
    return kind == "graph" ? HashFile(path, cancel)
                           : MapReader(path).Checksum(cancel);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kBadInput) throw;
    return "";
  }
}

}  // namespace

std::string NameForSources(const Stage& stage) {
  return kSourcePrefix + stage.name;
}

StagePlan::StagePlan(const Workspace& workspace,
                     const std::vector<StereoProblem>& problems,
                     const Schedule& schedule,
                     const ControllerOptions& options,
                     ImageContents* contents,
                     const CancelToken& cancel,
                     PlanAccess access)
    : workspace_(workspace),
      problems_(problems),
      options_(options),
      contents_(contents),
      cancel_(cancel),
      access_(access),
      stages_(MakeStages(schedule, options.hpm.keep_photometric)),
      share_(options.hpm) {
  Plan(/*look_at_maps=*/!options.hpm.overwrite);
}

void StagePlan::Plan(bool look_at_maps) {
  const std::vector<StereoProblem>& problems = problems_;
  const int num_stages = static_cast<int>(stages_.size());
  const int num_problems = static_cast<int>(problems.size());
  problem_of_image_.assign(workspace_.num_images(), -1);
  std::vector<int> images;
  for (int p = 0; p < num_problems; ++p) {
    problem_of_image_[problems[p].ref_image] = p;
    images.push_back(problems[p].ref_image);
    const std::vector<int>& sources = problems[p].src_images;
    images.insert(images.end(), sources.begin(), sources.end());
  }
  contents_->Read(images, cancel_);

  fingerprints_.clear();
  found_foreign_maps_ = false;
  for (int s = 0; s < num_stages; ++s) {
    fingerprints_.emplace_back(problems.size());
    const std::string of_stage = FingerprintOfStage(
        stages_[s].name, stages_[s].spec, stages_[s].is_final, options_);
    tbb::parallel_for(0, num_problems, [&](int p) {
      cancel_.ThrowIfCancelled();
      Fingerprint hash;
      hash.AddString(OwnFingerprint(
          workspace_, *contents_, problems[p], stages_[s].is_final, of_stage));
      if (s > 0) {
        hash.AddString(fingerprints_[s - 1][p]);
        for (const int src : problems[p].src_images) {
          if (!stages_[s].spec.geometric) break;
          const int q = problem_of_image_[src];
          hash.AddString(q < 0 ? "" : fingerprints_[s - 1][q]);
        }
      }
      fingerprints_[s][p] = hash.Hex();
    });
  }

  // Backwards: the maps COLMAP's users see must be finished; those of inner
  // passes only if the pass after them still has to read them.
  needed_.assign(num_stages, std::vector<bool>(num_problems, false));
  states_.assign(num_stages,
                 std::vector<MapState>(num_problems, MapState::kNotAsked));
  mine_ = share_.Problems(problems, workspace_.num_images());
  inputs_.assign(num_stages, std::vector<bool>(num_problems, false));
  num_open_ = 0;
  for (int s = num_stages - 1; s >= 0; --s) {
    std::vector<bool> wanted(num_problems);  // by the stage after
    for (int q = 0; q < num_problems; ++q) {
      if (s + 1 == num_stages || !needed_[s + 1][q]) continue;
      const bool is_mine = mine_[q] && share_.HasStage(stages_[s + 1].name);
      const auto want = [&](int p) {
        wanted[p] = true;
        if (is_mine) inputs_[s][p] = true;
      };
      want(q);
      if (!stages_[s + 1].spec.geometric) continue;
      for (const int src : problems[q].src_images) {
        if (problem_of_image_[src] >= 0) want(problem_of_image_[src]);
      }
    }
    std::vector<int> asked;
    for (int p = 0; p < num_problems; ++p) {
      if (CanBeComputed(workspace_, problems[p]) &&
          (wanted[p] || IsPublic(s, problems[p].ref_image))) {
        asked.push_back(p);
      }
    }
    std::vector<Found> found(asked.size());
    if (look_at_maps) {
      tbb::parallel_for(size_t{0}, asked.size(), [&](size_t i) {
        found[i] = Look(s, asked[i], !wanted[asked[i]]);
      });
    }
    for (size_t i = 0; i < asked.size(); ++i) {
      states_[s][asked[i]] = found[i].state;
      needed_[s][asked[i]] = found[i].state != MapState::kFinished;
      found_foreign_maps_ |= found[i].state == MapState::kForeign;
      damaged_maps_.insert(found[i].damaged.begin(), found[i].damaged.end());
    }
  }
  replaces_foreign_maps_ = replaces_foreign_maps_ && found_foreign_maps_;
  for (int s = 0; s < num_stages; ++s) {
    num_open_ += static_cast<int>(
        std::count(needed_[s].begin(), needed_[s].end(), true));
    const bool has_stage = share_.HasStage(stages_[s].name);
    for (int p = 0; p < num_problems; ++p)
      needed_[s][p] = needed_[s][p] && has_stage && mine_[p];
  }
}

std::vector<std::string> StagePlan::MissingInputs(int s) const {
  std::vector<std::string> names;
  if (s == 0) return names;
  for (int p = 0; p < static_cast<int>(problems_.size()); ++p) {
    if (!inputs_[s - 1][p] || !CanBeComputed(workspace_, problems_[p]))
      continue;
    const int image = problems_[p].ref_image;
    const StageFiles files = Files(s - 1, image);
    const bool is_damaged =
        !mine_[p] && states_[s - 1][p] == MapState::kDamaged;
    if (is_damaged || !HasCompleteMaps(s - 1, image) || !StateOf(files.depth) ||
        !StateOf(files.normal)) {
      names.push_back(workspace_.ImageName(image));
    }
  }
  return names;
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
            workspace_.MapPath(image, MapKind::kConsistencyGraph, stage),
            workspace_.MapPath(image, MapKind::kConfidence, stage)};
  }
  const std::filesystem::path folder = workspace_.StatePath() / stage;
  const std::string& name = workspace_.ImageName(image);
  return {
      folder / (name + ".depth.bin"), folder / (name + ".normal.bin"), {}, {}};
}

std::string StagePlan::FingerprintOnDisk(int s, int image) const {
  const std::optional<Stamp> stamp = ReadStamp(
      workspace_.StatePath(), workspace_.ImageName(image), NameOf(s, image));
  return stamp ? stamp->fingerprint : "";
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

bool StagePlan::HasSameImages(int p) const {
  const std::vector<int>& sources = problems_[p].src_images;
  return contents_->IsUnchanged(problems_[p].ref_image) &&
         std::all_of(sources.begin(), sources.end(), [&](int src) {
           return contents_->IsUnchanged(src);
         });
}

bool StagePlan::GetsMaps(int image) const {
  const int problem = problem_of_image_[image];
  return problem >= 0 && CanBeComputed(workspace_, problems_[problem]);
}

bool StagePlan::HasCompleteMaps(int s, int image) const {
  const int p = problem_of_image_[image];
  return p >= 0 && FingerprintOnDisk(s, image) == fingerprints_[s][p];
}

bool StagePlan::HasCurrentMaps(int s, int image) const {
  const int p = problem_of_image_[image];
  return HasCompleteMaps(s, image) ||
         (p >= 0 &&
          FingerprintOnDisk(s, image) == IncompleteFingerprintOf(s, p));
}

bool StagePlan::WritesGraph(int s, int image) const {
  return options_.patch_match.write_consistency_graph && IsPublic(s, image);
}

bool StagePlan::WritesConfidence(int s, int image) const {
  return options_.hpm.confidence && stages_[s].is_final && IsPublic(s, image);
}

StagePlan::Found StagePlan::Look(int s, int p, bool may_be_cut) const {
  const int image = problems_[p].ref_image;
  const StageFiles files = Files(s, image);
  Found found;
  if (!StateOf(files.depth) || !StateOf(files.normal)) return found;
  std::optional<Stamp> stamp = ReadStamp(
      workspace_.StatePath(), workspace_.ImageName(image), NameOf(s, image));
  const std::string fingerprint = stamp ? stamp->fingerprint : "";
  const bool is_complete = fingerprint == fingerprints_[s][p];
  const bool is_cut = fingerprint == CutFingerprintOf(s, p);
  const bool is_incomplete = fingerprint == IncompleteFingerprintOf(s, p);
  if (!is_complete && !is_cut && !is_incomplete) {
    found.state = MapState::kForeign;
    return found;
  }
  // Incomplete ones, too: where they cannot be made again, others go on with
  // them.
  // One of its own it can make again, for others that read it.
  const bool is_read = share_.IsWhole() || inputs_[s][p] || mine_[p];
  if (!AreIntact(s, image, is_read, &*stamp, &found)) {
    if (!found.damaged.empty()) found.state = MapState::kDamaged;
  } else if (is_complete || (is_cut && may_be_cut)) {
    found.state = MapState::kFinished;
  } else if (is_incomplete) {
    found.state = MapState::kIncomplete;
  }
  return found;
}

bool StagePlan::AreIntact(
    int s, int image, bool is_read, Stamp* stamp, Found* found) const {
  const StageFiles files = Files(s, image);
  std::map<std::string, std::filesystem::path> wanted = {
      {"depth", files.depth}, {"normal", files.normal}};
  if (WritesGraph(s, image)) wanted["graph"] = files.graph;
  if (WritesConfidence(s, image)) wanted["confidence"] = files.confidence;
  std::optional<std::string>& since = stamp->unsynced_since;
  const bool may_be_lost =
      is_read && since && (since->empty() || *since != BootId());
  bool is_absent = false, has_new_time = false;
  for (const auto& [kind, path] : wanted) {
    const std::optional<FileState> state = StateOf(path);
    const auto stamped = stamp->files.find(kind);
    if (!state || stamped == stamp->files.end()) {
      is_absent = true;
      continue;
    }
    PublishedFile& file = stamped->second;
    const bool has_same_state = *state == file.state;
    if (has_same_state && !may_be_lost && access_ != PlanAccess::kVerify)
      continue;
    if (state->num_bytes != file.state.num_bytes ||
        ChecksumOf(kind, path, cancel_) != file.checksum) {
      found->damaged.push_back(path);
      continue;
    }
    file.state = *state;
    has_new_time |= !has_same_state;
  }
  // Those of another shard are its own: it may be replacing them.
  if (access_ != PlanAccess::kRun || !mine_[problem_of_image_[image]])
    return !is_absent && found->damaged.empty();
  const std::filesystem::path& folder = workspace_.StatePath();
  const std::string& name = workspace_.ImageName(image);
  if (!found->damaged.empty()) {
    // Nobody may take these maps for good ones, even if they cannot be made
    // again.
    RemoveStamp(folder, name, NameOf(s, image));
  } else if (has_new_time || (may_be_lost && !since->empty())) {
    // These may be copies, of which nobody knows whether they were synced.
    since = UnsyncedSince(folder);
    try {
      WriteStamp(folder, name, NameOf(s, image), *stamp);
    } catch (const Error&) {
      // On a full disk the next run has to compare the checksums again.
    }
  }
  return !is_absent && found->damaged.empty();
}

void RemoveInnerMaps(const Workspace& workspace) {
  std::error_code error;
  std::vector<std::filesystem::path> folders;
  for (std::filesystem::directory_iterator it(workspace.StatePath(), error),
       end;
       !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    for (const char* prefix :
         {kLevelPrefix, kGeometricPrefix, kSourcePrefix, kPhotometric}) {
      if (StartsWith(name, prefix)) folders.push_back(it->path());
    }
  }
  if (folders.empty()) return;
  // A power cut must not take what vouches for the maps that were made of them.
  for (const char* stage : {kPhotometric, kGeometric})
    SyncStamps(workspace.StatePath(), stage);
  for (const std::filesystem::path& folder : folders)
    std::filesystem::remove_all(folder, error);
}

}  // namespace hpm
