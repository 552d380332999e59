// The stages of a run (schedule.h) and what is left to do in each. A stage of
// an image is finished when its maps are complete and its stamp carries the
// fingerprint of everything the maps depend on, the contents of the images
// among it, and vouches for the maps.
#pragma once

#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/controller/run_share.h"
#include "colmap_plugin/options/options.h"
#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/cancel.h"
#include "src/engine/schedule.h"

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace hpm {

struct Stage {
  // "photometric", "geometric_1", ..., "geometric"; at reduced scale
  // "level_2_photometric" and so on.
  std::string name;
  // For people: "searching at half size, pass 1 of 5".
  std::string title;
  StageSpec spec;
  // Its maps of references lie where COLMAP looks for them.
  bool is_public = false;
  bool is_final = false;  // filtered, if asked for; its maps are the result
};

// Under which the maps of problems that are only sources are kept: an image may
// be a reference in the next run.
std::string NameForSources(const Stage& stage);

struct StageFiles {
  std::filesystem::path depth, normal, graph, confidence;
};

// What was found of the maps of a stage of an image.
enum class MapState {
  kNotAsked,  // nobody needs them (any more), or they cannot be computed
  kFinished,
  kMissing,
  kForeign,  // made with other options or inputs, or by others
  kIncomplete,
  kDamaged,
};

// How planning looks at files.
enum class PlanAccess {
  kRun,      // corrects stamps, keeps what it measured of deep images
  kInspect,  // changes no file
  kVerify,   // likewise, and trusts no length and time
};

class StagePlan {
 public:
  // Looks at the files of the workspace; computes nothing. Maps whose size and
  // time are those of their stamp are trusted, of others the checksum decides:
  // then the stamp gets the new time, or goes. Keeps references to all but the
  // schedule. Throws Error(kInterrupted).
  StagePlan(const Workspace& workspace,
            const std::vector<StereoProblem>& problems,
            const Schedule& schedule,
            const ControllerOptions& options,
            ImageContents* contents,
            const CancelToken& cancel,
            PlanAccess access = PlanAccess::kRun);

  // Plans anew after the problems, of the same references, changed. What the
  // run has made meanwhile stays, with --Hpm.overwrite, too.
  void Update() { Plan(/*look_at_maps=*/true); }

  const std::vector<Stage>& stages() const { return stages_; }
  // Whether problem p has to be computed in stage s, and can be: its final
  // maps, or maps that others still need, are missing, damaged or made with
  // other options.
  bool IsNeeded(int s, int p) const { return needed_[s][p]; }
  // As it was found, by the newest plan.
  MapState StateAt(int s, int p) const { return states_[s][p]; }
  // Whether the problem is of this process's shard, see RunShare. Only its own
  // are needed, and in its own stages.
  bool IsMine(int p) const { return mine_[p]; }
  // In all stages, of all shards.
  int num_open() const { return num_open_; }
  // Of stage s - 1: images whose maps stage s of this process's shard reads and
  // that are not there (yet), or were made from others that were not.
  std::vector<std::string> MissingInputs(int s) const;
  // True if maps exist that were made with other options, from other images, by
  // another version or by another program, in the eyes of all plans so far.
  bool ReplacesForeignMaps() const { return replaces_foreign_maps_; }
  // Maps that are not what their valid stamp says.
  const std::set<std::filesystem::path>& damaged_maps() const {
    return damaged_maps_;
  }
  const std::string& FingerprintOf(int s, int p) const {
    return fingerprints_[s][p];
  }
  // What the stamp holds if maps of a source were missing, or images changed
  // while they were used: good enough to go on with, computed again by the next
  // run.
  std::string IncompleteFingerprintOf(int s, int p) const {
    return fingerprints_[s][p] + "-incomplete";
  }
  // What the stamp of a public stage before the last holds once its maps were
  // cut to a depth range given by hand (cut_maps.h): finished for users, of no
  // use to the stage after.
  std::string CutFingerprintOf(int s, int p) const;
  StageFiles Files(int s, int image) const;
  // The stage's name, in files and stamps, for this image.
  std::string NameOf(int s, int image) const;
  // Whether the maps of stage s of the image, if it has a problem, are for
  // others than this program.
  bool IsPublic(int s, int image) const;
  // Whether the images that problem p was planned with are still the same.
  bool HasSameImages(int p) const;
  // Whether the image's maps of stage s are those of this plan.
  bool HasCompleteMaps(int s, int image) const;
  // The same, or made without the maps of some source that failed.
  bool HasCurrentMaps(int s, int image) const;
  // Whether a run makes maps of the image, unless something fails.
  bool GetsMaps(int image) const;
  // The image's camera at the scale of the stage, its own centre the origin.
  Camera CameraOf(int s, int image) const {
    return LevelCamera(workspace_.camera(image), stages_[s].spec.level);
  }
  bool WritesGraph(int s, int image) const;
  bool WritesConfidence(int s, int image) const;

 private:
  struct Found {
    MapState state = MapState::kMissing;
    std::vector<std::filesystem::path> damaged;
  };
  void Plan(bool look_at_maps);
  Found Look(int s, int p, bool may_be_cut) const;
  // Whether the files are those the stamp vouches for; see the constructor.
  // is_read: by this process, so that what was not synced must be compared.
  bool AreIntact(
      int s, int image, bool is_read, Stamp* stamp, Found* found) const;
  std::string FingerprintOnDisk(int s, int image) const;

  const Workspace& workspace_;
  const std::vector<StereoProblem>& problems_;
  const ControllerOptions& options_;
  ImageContents* contents_;
  const CancelToken& cancel_;
  const PlanAccess access_;
  std::vector<Stage> stages_;
  // -1: the image is neither a reference nor a source of one.
  std::vector<int> problem_of_image_;
  std::vector<std::vector<std::string>> fingerprints_;  // [stage][problem]
  std::vector<std::vector<bool>> needed_;               // [stage][problem]
  std::vector<std::vector<MapState>> states_;           // [stage][problem]
  const RunShare share_;
  std::vector<bool> mine_;  // [problem]
  // [stage][problem], whether a later stage of this process reads the maps.
  std::vector<std::vector<bool>> inputs_;
  int num_open_ = 0;
  std::set<std::filesystem::path> damaged_maps_;
  bool found_foreign_maps_ = false;    // by the newest plan
  bool replaces_foreign_maps_ = true;  // until a plan finds none
};

// Removes the maps between stages, of any run, once the stamps of the others
// are synced: once all was made that can be,
// they are of no use. A later run that lacks some result makes those it needs
// again, to the same bytes.
void RemoveInnerMaps(const Workspace& workspace);

}  // namespace hpm
