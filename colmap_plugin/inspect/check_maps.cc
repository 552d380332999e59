#include "colmap_plugin/inspect/check_maps.h"

#include "colmap_plugin/formats/content_hash.h"
#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/inspect/map_faults.h"
#include "colmap_plugin/inspect/planned_run.h"
#include "colmap_plugin/workspace/image_files.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/base/input_file.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

constexpr char kOfNoImage[] = "belongs to no image of the model";

class Checker {
 public:
  Checker(const Workspace& workspace,
          const std::vector<StereoProblem>& problems,
          const StagePlan& plan,
          bool fix,
          const RunLock* lock,
          const CancelToken& cancel)
      : workspace_(workspace),
        problems_(problems),
        plan_(plan),
        fix_(fix),
        lock_(lock),
        cancel_(cancel) {}

  MapCheck Run() {
    const size_t num_problems = problems_.size();
    const size_t num_stages = plan_.stages().size();
    std::vector<MapCheck> parts(num_stages * num_problems);
    tbb::parallel_for(size_t{0}, parts.size(), [&](size_t i) {
      CheckStage(static_cast<int>(i / num_problems),
                 static_cast<int>(i % num_problems),
                 &parts[i]);
    });
    MapCheck all;
    for (MapCheck& part : parts) Join(std::move(part), &all);
    for (size_t s = 0; s < num_stages; ++s) {
      for (const StereoProblem& problem : problems_) {
        const StageFiles files =
            plan_.Files(static_cast<int>(s), problem.ref_image);
        known_.insert(
            {files.depth, files.normal, files.graph, files.confidence});
      }
    }
    for (const char* folder :
         {"depth_maps", "normal_maps", "consistency_graphs", "confidence_maps"})
      CheckOthers(folder, &all);
    CheckOtherStamps(&all);
    return all;
  }

 private:
  static void Join(MapCheck part, MapCheck* all) {
    all->num_files += part.num_files;
    std::move(part.findings.begin(),
              part.findings.end(),
              std::back_inserter(all->findings));
  }

  std::string Relative(const fs::path& path) const {
    return path.lexically_relative(workspace_.StereoPath()).string();
  }

  void Add(FindingKind kind,
           const fs::path& path,
           const std::string& reason,
           MapCheck* check) const {
    check->findings.push_back({kind, Relative(path), reason});
  }

  // With the stamp that may vouch for the file.
  void AddDamaged(const fs::path& path,
                  const std::string& reason,
                  const fs::path& stamp,
                  MapCheck* check) const {
    Finding finding = {FindingKind::kDamaged, Relative(path), reason};
    if (fix_) {
      lock_->ThrowIfLost();
      Remove(stamp);  // first, so that it never vouches for what is not there
      Remove(path);
      finding.removed = true;
    }
    check->findings.push_back(finding);
  }

  static void Remove(const fs::path& path) {
    if (path.empty()) return;
    std::error_code error;
    fs::remove(path, error);
    if (!error) return;
    throw Error(ErrorCode::kBadInput,
                fmt::format("{} cannot be removed: {}; check the permissions "
                            "of its folder",
                            path.string(),
                            error.message()));
  }

  std::string FaultOf(MapKind kind,
                      const fs::path& path,
                      const DepthRange& range) const {
    switch (kind) {
      case MapKind::kDepth:
        return FaultOfDepths(path, range);
      case MapKind::kNormal:
        return FaultOfNormals(path);
      case MapKind::kConfidence:
        return FaultOfConfidence(path);
      case MapKind::kConsistencyGraph:
        break;
    }
    return FaultOfGraph(path, workspace_.num_images());
  }

  // Maps of other proportions than their image are of no use to fusion either.
  std::string FaultOfSize(const fs::path& path,
                          MapKind kind,
                          const Camera& camera) const {
    if (kind == MapKind::kConsistencyGraph || camera.width == 0) return "";
    const MapHeader header = ReadMapHeader(path);
    if (SameProportions({camera.width, camera.height},
                        {header.width, header.height})) {
      return "";
    }
    return fmt::format("is {}x{}, its image {}x{}",
                       header.width,
                       header.height,
                       camera.width,
                       camera.height);
  }

  std::string ChecksumOf(MapKind kind, const fs::path& path) const {
    return kind == MapKind::kConsistencyGraph
               ? HashFile(path, cancel_)
               : MapReader(path).Checksum(cancel_);
  }

  // Adds what is wrong with the map, which has this checksum in its stamp, and
  // returns whether anything is.
  bool AddFault(MapKind kind,
                const fs::path& path,
                const DepthRange& range,
                const Camera& camera,
                const std::optional<std::string>& checksum,
                const fs::path& stamp,
                MapCheck* check) const {
    try {
      std::string fault = FaultOf(kind, path, range);
      ++check->num_files;
      if (fault.empty()) fault = FaultOfSize(path, kind, camera);
      if (fault.empty() && checksum && ChecksumOf(kind, path) != *checksum) {
        fault =
            "was changed after it was made: its checksum is not that of "
            "its stamp";
      }
      if (fault.empty()) return false;
      AddDamaged(path, fault, stamp, check);
    } catch (const UnreadableFile& error) {
      // Nobody knows that it is bad, so it stays.
      Add(FindingKind::kUnreadable, path, error.what(), check);
    }
    return true;
  }

  // Reads the stamp or adds why it is of no use, and returns whether it did the
  // latter.
  bool AddStampFault(const fs::path& path,
                     std::optional<Stamp>* stamp,
                     MapCheck* check) const {
    if (!StateOf(path)) return false;
    try {
      *stamp = ReadStampFile(path);
      if (*stamp) return false;
      AddDamaged(path, "is no stamp of this version of the program", {}, check);
    } catch (const UnreadableFile& error) {
      Add(FindingKind::kUnreadable, path, error.what(), check);
    }
    return true;
  }

  void CheckStage(int s, int p, MapCheck* check) const {
    cancel_.ThrowIfCancelled();
    const StereoProblem& problem = problems_[p];
    const int image = problem.ref_image;
    const std::string& name = workspace_.ImageName(image);
    const std::string stage = plan_.NameOf(s, image);
    const bool is_public = plan_.IsPublic(s, image);
    const std::string what = name + " " + stage;
    const auto add = [&](FindingKind kind, const std::string& reason) {
      check->findings.push_back({kind, what, reason});
    };
    const fs::path stamp_path = StampPath(workspace_.StatePath(), name, stage);
    std::optional<Stamp> stamp;
    bool has_fault = AddStampFault(stamp_path, &stamp, check);
    // Of maps that are the last of a run.
    const DepthRange& range =
        plan_.stages()[s].is_final && stamp &&
                stamp->fingerprint == plan_.FingerprintOf(s, p)
            ? problem.published
            : kAnyDepth;

    const StageFiles files = plan_.Files(s, image);
    bool any = false, all = true;
    const auto look = [&](const char* in_stamp,
                          MapKind kind,
                          const fs::path& path,
                          bool wanted) {
      if (path.empty()) return;
      if (!StateOf(path)) {
        all &= !wanted;
        return;
      }
      any = true;
      std::optional<std::string> checksum;
      if (stamp && stamp->files.count(in_stamp) > 0)
        checksum = stamp->files[in_stamp].checksum;
      has_fault |= AddFault(kind,
                            path,
                            range,
                            plan_.CameraOf(s, image),
                            checksum,
                            stamp_path,
                            check);
    };
    look("depth", MapKind::kDepth, files.depth, true);
    look("normal", MapKind::kNormal, files.normal, true);
    look("graph",
         MapKind::kConsistencyGraph,
         files.graph,
         plan_.WritesGraph(s, image));
    look("confidence",
         MapKind::kConfidence,
         files.confidence,
         plan_.WritesConfidence(s, image));

    if (has_fault) return;  // was told
    if (!CanBeComputed(workspace_, problem)) {
      if (is_public && problem.is_reference) {
        add(FindingKind::kMissing,
            std::string(any ? "what is there is of an earlier run, and fusion "
                              "would use it: "
                            : "") +
                "the image cannot be computed: no picture of it or of any "
                "source");
      }
      return;
    }
    if (!any || !all) {
      if (is_public)
        add(FindingKind::kMissing,
            any ? "some of its files are not there" : "not computed yet");
      return;
    }
    if (!stamp) {
      add(FindingKind::kUnstamped,
          "made by another program, or by a run that was "
          "stopped just then");
    } else if (stamp->fingerprint == plan_.IncompleteFingerprintOf(s, p)) {
      add(FindingKind::kStale,
          "made while maps of a source were missing or images changed");
    } else if (stamp->fingerprint != plan_.FingerprintOf(s, p) &&
               stamp->fingerprint != plan_.CutFingerprintOf(s, p)) {
      add(FindingKind::kStale,
          "made with other options, from other images or by another version");
    }
  }

  // "<image of the model>.<stage>.bin" -> that image.
  int ImageOf(const std::string& file) const {
    for (const char* stage : {".photometric.bin", ".geometric.bin"}) {
      const size_t length = std::char_traits<char>::length(stage);
      if (file.size() > length &&
          file.compare(file.size() - length, length, stage) == 0) {
        return workspace_.ImageIndex(file.substr(0, file.size() - length));
      }
    }
    return -1;
  }

  // Files of the folder that the run does not make.
  void CheckOthers(const std::string& folder, MapCheck* check) const {
    const fs::path root = workspace_.StereoPath() / folder;
    MapKind kind = MapKind::kConsistencyGraph;
    if (folder == "depth_maps") kind = MapKind::kDepth;
    if (folder == "normal_maps") kind = MapKind::kNormal;
    if (folder == "confidence_maps") kind = MapKind::kConfidence;
    for (const fs::path& path : FilesBelow(root, ".bin", check)) {
      if (known_.count(path) > 0) continue;
      cancel_.ThrowIfCancelled();
      const int image = ImageOf(path.lexically_relative(root).string());
      if (image < 0) {
        Add(FindingKind::kForeign, path, kOfNoImage, check);
        continue;
      }
      const Camera& camera = workspace_.camera(image);
      if (!AddFault(kind, path, kAnyDepth, camera, {}, {}, check)) {
        Add(FindingKind::kForeign,
            path,
            "a run with these options does not make it",
            check);
      }
    }
  }

  void CheckOtherStamps(MapCheck* check) const {
    const fs::path root = workspace_.StatePath() / "stamps";
    for (const fs::path& path : FilesBelow(root, ".json", check)) {
      const fs::path below = path.lexically_relative(root);
      fs::path name = below.lexically_relative(*below.begin());
      name.replace_extension();
      if (workspace_.ImageIndex(name.string()) < 0)
        Add(FindingKind::kForeign, path, kOfNoImage, check);
    }
  }

  // A folder that is not there holds none; one that cannot be read is told.
  std::vector<fs::path> FilesBelow(const fs::path& root,
                                   const std::string& extension,
                                   MapCheck* check) const {
    std::vector<fs::path> files;
    std::error_code error;
    fs::path at = root;
    for (fs::recursive_directory_iterator it(root, error), end;
         !error && it != end;
         it.increment(error)) {
      std::error_code ignored;
      at = it->path();
      if (at.extension() == extension && it->is_regular_file(ignored))
        files.push_back(at);
    }
    if (error && error != std::errc::no_such_file_or_directory) {
      Add(FindingKind::kUnreadable,
          at,
          "the folder cannot be read from here on: " + error.message(),
          check);
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  const Workspace& workspace_;
  const std::vector<StereoProblem>& problems_;
  const StagePlan& plan_;
  const bool fix_;
  const RunLock* lock_;
  const CancelToken& cancel_;
  std::set<fs::path> known_;
};

}  // namespace

MapCheck CheckMaps(const ControllerOptions& options,
                   bool fix,
                   const LogSink& log,
                   const CancelToken& cancel) {
  CancelToken stop(&cancel);
  PlannedRun run(options, log, stop);
  std::optional<RunLock> lock;
  if (fix) lock.emplace(run.workspace().StatePath(), log, &stop);
  run.Plan(/*look_at_maps=*/false, log);
  return Checker(run.workspace(),
                 run.problems(),
                 run.plan(),
                 fix,
                 lock ? &*lock : nullptr,
                 stop)
      .Run();
}

}  // namespace hpm
