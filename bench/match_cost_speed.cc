// Matching costs per second and core of every SIMD target, on the requests of a
// real run: the middle band of a closed-form scene, initialisation and
// iterations of NESP, recorded once and replayed by each target in turn.
//
//   match_cost_speed [--width 1200] [--height 900] [--srcs 8] [--rounds 5]
#include "bench/eval/program.h"
#include "bench/synthetic_views.h"
#include "src/cpu/cpu_backend.h"
#include "src/cpu/cpu_views.h"
#include "src/engine/run_passes.h"

#include <algorithm>
#include <chrono>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hpm {
namespace {

namespace po = boost::program_options;

constexpr int kBandRows = 8;

// A MatchRequest that outlives its visit.
struct Recorded {
  int col, row;
  int first_plane, num_planes;
  int num_views;
  uint8_t views[kMaxViews];
};

// What the recorder keeps. Global: a MatchCostFunction carries no state.
struct Recording {
  int first_row = 0;
  std::vector<Recorded> requests;
  std::vector<Plane> planes;
  size_t num_pairs = 0;
} recording;

void RecordMatchCosts(const MatchViews& match,
                      const RefPatch& patch,
                      const MatchRequest& request,
                      float* costs) {
  static const MatchCostFunction match_cost = FindCpuTarget("auto").match_costs;
  match_cost(match, patch, request, costs);
  if (request.row < recording.first_row ||
      request.row >= recording.first_row + kBandRows) {
    return;
  }
  Recorded recorded = {request.col,
                       request.row,
                       static_cast<int>(recording.planes.size()),
                       request.num_planes,
                       request.num_views,
                       {}};
  std::copy_n(request.views, request.num_views, recorded.views);
  recording.requests.push_back(recorded);
  recording.planes.insert(recording.planes.end(),
                          request.planes,
                          request.planes + request.num_planes);
  recording.num_pairs += static_cast<size_t>(request.num_pairs());
}

void Record(const ViewSet& views) {
  ScheduleOptions options;
  options.method = "nesp";
  options.num_geom_passes = 0;
  const Schedule schedule = MakeSchedule(options);
  recording.first_row = views.ref.camera.height / 2;
  // One thread: the recording keeps the order of the visits.
  const auto backend =
      MakeCpuBackend({"recorder", &RecordMatchCosts, nullptr}, 1);
  HypothesisMap map(views.ref.camera.width, views.ref.camera.height);
  const CancelToken cancel;
  PhaseTimes times;
  RunPasses(backend.get(),
            views,
            schedule,
            schedule.stages.front(),
            MethodParams(),
            {&cancel, nullptr},
            &map,
            &times);
}

// Seconds for all recorded requests; reference patches are made before.
double Replay(const CpuTarget& target,
              const CpuViews& views,
              const std::vector<RefPatch>& patches,
              double* checksum) {
  float costs[kNumRegions * kMaxViews];
  double sum = 0;
  const auto start = std::chrono::steady_clock::now();
  for (const Recorded& recorded : recording.requests) {
    const int patch =
        (recorded.row - recording.first_row) * views.match().ref.width +
        recorded.col;
    target.match_costs(views.match(),
                       patches[patch],
                       {recorded.col,
                        recorded.row,
                        &recording.planes[recorded.first_plane],
                        recorded.num_planes,
                        recorded.views,
                        recorded.num_views},
                       costs);
    sum += costs[0];
  }
  *checksum = sum;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

void Run(const po::variables_map& args) {
  const SyntheticProblem problem =
      MakeSyntheticProblem(args["scene"].as<std::string>(),
                           args["width"].as<int>(),
                           args["height"].as<int>(),
                           args["srcs"].as<int>());
  Record(problem.photometric);
  const CpuViews views(problem.photometric, MethodParams());
  std::vector<RefPatch> patches;
  for (int row = 0; row < kBandRows; ++row) {
    for (int col = 0; col < views.match().ref.width; ++col) {
      patches.push_back(views.PatchAt(col, recording.first_row + row));
    }
  }
  const std::vector<CpuTarget> targets = CpuTargets();
  std::vector<double> best(targets.size(), 1e30), checksum(targets.size());
  for (int round = 0; round < args["rounds"].as<int>(); ++round) {
    for (size_t i = 0; i < targets.size(); ++i) {
      best[i] =
          std::min(best[i], Replay(targets[i], views, patches, &checksum[i]));
    }
  }
  const double pairs = static_cast<double>(recording.num_pairs);
  fmt::print("{} requests, {:.1f} pairs each; best of {} rounds\n",
             recording.requests.size(),
             pairs / static_cast<double>(recording.requests.size()),
             args["rounds"].as<int>());
  nlohmann::json record = {{"requests", recording.requests.size()},
                           {"pairs", recording.num_pairs}};
  for (size_t i = 0; i < targets.size(); ++i) {
    fmt::print(
        "{:<8} {:7.1f} ns per cost  {:6.2f} M costs/s  mean cost {:.5f}\n",
        targets[i].name,
        1e9 * best[i] / pairs,
        1e-6 * pairs / best[i],
        checksum[i] / static_cast<double>(recording.requests.size()));
    record["ns_per_cost"][targets[i].name] = 1e9 * best[i] / pairs;
  }
  if (args.count("json"))
    std::ofstream(args["json"].as<std::string>()) << record.dump(1) << "\n";
}

}  // namespace
}  // namespace hpm

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  po::options_description options("Options");
  options.add_options()(
      "scene", po::value<std::string>()->default_value("depth_step"), "name")(
      "width", po::value<int>()->default_value(1200), "of the images, pixels")(
      "height", po::value<int>()->default_value(900), "")(
      "srcs", po::value<int>()->default_value(8), "source images")(
      "rounds", po::value<int>()->default_value(5), "the best one counts")(
      "json", po::value<std::string>(), "also write the result here");
  return hpm::RunProgram(argc,
                         argv,
                         "Speed of the matching cost on one core",
                         std::move(options),
                         {},
                         &hpm::Run);
}
