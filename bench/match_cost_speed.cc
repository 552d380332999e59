// Matching costs per second and core of every SIMD target, on the requests of a
// real run: the middle band of a closed-form scene, initialisation and
// iterations of a method's first stage, recorded once and replayed by each
// target in turn.
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
#include <map>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hpm {
namespace {

namespace po = boost::program_options;

constexpr int kBandRows = 8;

// A MatchRequest that outlives its visit.
struct Recorded {
  int col, row;
  int pixel;
  size_t first_plane;
  int num_planes;
  int num_views;
  uint8_t views[kMaxViews];
};

// What the recorder keeps. Global: a MatchCostFunction carries no state.
struct Recording {
  int first_row = 0;
  std::vector<Recorded> requests;
  std::vector<size_t> calls;  // first request of each
  std::vector<Plane> planes;
  size_t num_pairs = 0;
} recording;

void RecordMatchCosts(const MatchViews& match,
                      const RefPatches& patches,
                      const MatchRequest* requests,
                      int num_requests) {
  static const MatchCostFunction match_cost = FindCpuTarget("auto").match_costs;
  match_cost(match, patches, requests, num_requests);
  const int row = requests[0].asked.row;
  if (row < recording.first_row || row >= recording.first_row + kBandRows)
    return;
  recording.calls.push_back(recording.requests.size());
  for (int i = 0; i < num_requests; ++i) {
    const PlanesInViews& asked = requests[i].asked;
    Recorded recorded = {asked.col,
                         asked.row,
                         requests[i].pixel,
                         recording.planes.size(),
                         asked.num_planes,
                         asked.num_views,
                         {}};
    std::copy_n(asked.views, asked.num_views, recorded.views);
    recording.requests.push_back(recorded);
    recording.planes.insert(
        recording.planes.end(), asked.planes, asked.planes + asked.num_planes);
    recording.num_pairs += static_cast<size_t>(asked.num_pairs());
  }
}

void Record(const ViewSet& views, const std::string& method) {
  ScheduleOptions options;
  options.method = method;
  options.num_geom_passes = 0;
  const Schedule schedule = MakeSchedule(options);
  recording.first_row = views.ref.camera.height / 2;
  // One thread: the recording keeps the order of the visits.
  const auto backend = MakeCpuBackend(
      {"recorder", &RecordMatchCosts, nullptr, FindCpuTarget("auto").num_lanes},
      1);
  HypothesisMap map(views.ref.camera.width, views.ref.camera.height);
  const CancelToken cancel;
  PhaseTimes times;
  RunPasses(backend.get(),
            views,
            schedule,
            schedule.stages.front(),
            DefaultParams(FindMethod(method)),
            {&cancel, nullptr},
            &map,
            &times);
}

// The patches of the groups that the calls are about, made before.
class Patches {
 public:
  explicit Patches(const CpuViews& views) {
    for (const Recorded& recorded : recording.requests) {
      std::unique_ptr<RefPatches>& group = groups_[GroupOf(recorded)];
      if (group == nullptr) group = std::make_unique<RefPatches>();
      group->Set(recorded.pixel, views.PatchAt(recorded.col, recorded.row));
    }
    for (const size_t first : recording.calls)
      of_calls_.push_back(groups_[GroupOf(recording.requests[first])].get());
  }

  const RefPatches& OfCall(size_t call) const { return *of_calls_[call]; }

 private:
  // Row and column of its first pixel.
  static std::pair<int, int> GroupOf(const Recorded& recorded) {
    return {recorded.row, recorded.col - 2 * recorded.pixel};
  }

  std::map<std::pair<int, int>, std::unique_ptr<RefPatches>> groups_;
  std::vector<const RefPatches*> of_calls_;
};

// Seconds for all recorded calls, with the requests of a call at once or each
// on its own.
double Replay(const CpuTarget& target,
              const CpuViews& views,
              const Patches& patches,
              bool together,
              double* checksum) {
  std::vector<MatchRequest> requests;
  std::vector<float> costs(kMaxGroup * kNumRegions * kMaxViews);
  double sum = 0;
  const auto start = std::chrono::steady_clock::now();
  for (size_t call = 0; call < recording.calls.size(); ++call) {
    const size_t end = call + 1 < recording.calls.size()
                           ? recording.calls[call + 1]
                           : recording.requests.size();
    requests.clear();
    float* result = costs.data();
    for (size_t i = recording.calls[call]; i < end; ++i) {
      const Recorded& recorded = recording.requests[i];
      requests.push_back({{recorded.col,
                           recorded.row,
                           &recording.planes[recorded.first_plane],
                           recorded.num_planes,
                           recorded.views,
                           recorded.num_views},
                          recorded.pixel,
                          result});
      result += requests.back().asked.num_pairs();
    }
    const int num_requests = static_cast<int>(requests.size());
    const int step = together ? num_requests : 1;
    for (int i = 0; i < num_requests; i += step) {
      target.match_costs(
          views.match(), patches.OfCall(call), &requests[i], step);
    }
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
  const std::string method = args["method"].as<std::string>();
  Record(problem.photometric, method);
  const CpuViews views(problem.photometric, DefaultParams(FindMethod(method)));
  const Patches patches(views);
  const std::vector<CpuTarget> targets = CpuTargets();
  struct Best {
    double together = 1e30, alone = 1e30, checksum = 0;
  };
  std::vector<Best> best(targets.size());
  for (int round = 0; round < args["rounds"].as<int>(); ++round) {
    for (size_t i = 0; i < targets.size(); ++i) {
      double* sum = &best[i].checksum;
      best[i].alone = std::min(best[i].alone,
                               Replay(targets[i], views, patches, false, sum));
      best[i].together = std::min(
          best[i].together, Replay(targets[i], views, patches, true, sum));
    }
  }
  const double pairs = static_cast<double>(recording.num_pairs);
  const double requests = static_cast<double>(recording.requests.size());
  const double calls = static_cast<double>(recording.calls.size());
  fmt::print(
      "{} calls, {:.1f} requests each, of {:.1f} pairs; best of {} rounds\n",
      recording.calls.size(),
      requests / calls,
      pairs / requests,
      args["rounds"].as<int>());
  nlohmann::json record = {{"calls", recording.calls.size()},
                           {"requests", recording.requests.size()},
                           {"pairs", recording.num_pairs}};
  for (size_t i = 0; i < targets.size(); ++i) {
    fmt::print(
        "{:<8} {:7.1f} ns per cost, {:7.1f} one request at a time, mean cost "
        "{:.5f}\n",
        targets[i].name,
        1e9 * best[i].together / pairs,
        1e9 * best[i].alone / pairs,
        best[i].checksum / calls);
    record["ns_per_cost"][targets[i].name] = 1e9 * best[i].together / pairs;
    record["ns_per_cost_alone"][targets[i].name] = 1e9 * best[i].alone / pairs;
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
      "method", po::value<std::string>()->default_value("hpm_plus"), "")(
      "rounds", po::value<int>()->default_value(5), "the best one counts")(
      "json", po::value<std::string>(), "also write the result here");
  return hpm::RunProgram(argc,
                         argv,
                         "Speed of the matching cost on one core",
                         std::move(options),
                         {},
                         &hpm::Run);
}
