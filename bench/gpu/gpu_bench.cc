// Times the CUDA backend on closed-form scenes; see bench/gpu_bench.sh.
//
//   hpm_gpu_bench --out results.json [--width 3200] [--height 2130]
//       [--srcs 10,20] [--scene depth_step] [--images 6] [--flight 1,3]
//       [--quick 1]
#include "bench/gpu/json.h"
#include "bench/gpu/sampler_rate.h"
#include "bench/synthetic_views.h"
#include "cuda/cuda_backend.h"
#include "cuda/cuda_devices.h"
#include "cuda/self_test.h"
#include "src/core/sampling_pattern.h"
#include "src/engine/estimator.h"

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <mutex>
#include <sstream>

namespace hpm {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Settings {
  std::string out = "gpu.json", scene = "depth_step";
  int width = 3200, height = 2130, images = 6;
  std::vector<int> srcs = {10, 20}, flight = {1, 3};
  bool quick = false;
};

struct Variant {
  const char* name;
  ImageFormat format;
  bool pooled;
  int log_tile_width;
};

const Variant kVariants[] = {
    {"byte pooled 8x8", ImageFormat::kByte, true, 3},
    {"byte direct 8x8", ImageFormat::kByte, false, 3},
    {"byte pooled 16x4", ImageFormat::kByte, true, 4},
    {"byte pooled 64x1", ImageFormat::kByte, true, 6},
    {"half pooled 8x8", ImageFormat::kHalf, true, 3},
    {"float pooled 8x8", ImageFormat::kFloat, true, 3},
    {"quad pooled 8x8", ImageFormat::kQuad, true, 3},
    {"quad direct 8x8", ImageFormat::kQuad, false, 3},
    {"quad pooled 32x2", ImageFormat::kQuad, true, 5},
    {"quad pooled 64x1", ImageFormat::kQuad, true, 6},
};

CudaOptions OptionsOf(const Variant& variant) {
  CudaOptions options;
  options.format = variant.format;
  options.pooled = variant.pooled;
  options.log_tile_width = variant.log_tile_width;
  return options;
}

// Share of the pixels with a true depth that lie within 1 % of it.
double GoodShare(const HypothesisMap& map, const RenderedView& truth) {
  size_t num_good = 0, num_true = 0;
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const size_t at = static_cast<size_t>(row) * map.width + col;
      const float z = truth.truth.depth[at];
      if (!(z > 0)) continue;
      const float found = DepthAt(truth.camera,
                                  map.planes[at],
                                  static_cast<float>(col),
                                  static_cast<float>(row));
      ++num_true;
      num_good += std::abs(found - z) <= 0.01f * z;
    }
  }
  return static_cast<double>(num_good) / static_cast<double>(num_true);
}

Json AsJson(const std::map<std::string, double>& times) {
  Json json;
  for (const auto& [name, seconds] : times) json.Add(name, seconds);
  return json;
}

// What a card could do at most, from its clock and number of processors.
struct Bounds {
  double samples_per_second;  // 4 filtered samples per clock and processor
  double fp32_per_second;     // instructions, 128 per clock and processor
};

Bounds BoundsOf(const CudaDevice& device) {
  const double clocks = device.num_processors * device.clock_ghz * 1e9;
  return {4 * clocks, 128 * clocks};
}

// FP32 instructions per sample of the inner loop, counted in pair_cost.h:
// 3 warp, 2 divide, 1 subtract, 4 sums, 1 scale.
constexpr double kInstructionsPerSample = 11;

// Basic pass of one image: the kernels alone.
Json TimeVariant(const Variant& variant,
                 const SyntheticProblem& problem,
                 const Bounds& bounds) {
  const auto backend = MakeCudaBackend(OptionsOf(variant));
  backend->SetViews(problem.photometric, MethodParams());
  const CancelToken cancel;
  const Camera& camera = problem.photometric.ref.camera;
  HypothesisMap map(camera.width, camera.height);
  const Pass pass = {PassKind::kBasic, StartFrom::kRandom, 3, 0};
  const SamplingPattern pattern = MakeSamplingPattern(true, true);
  backend->Run(pass, pattern, &map, {&cancel, nullptr, false});  // warm up
  const std::map<std::string, double> before = backend->seconds();
  const uint64_t count_before = backend->num_cost_evaluations();
  map = HypothesisMap(camera.width, camera.height);
  backend->Run(pass, pattern, &map, {&cancel, nullptr, false});
  std::map<std::string, double> seconds = backend->seconds();
  for (const auto& [name, value] : before) seconds[name] -= value;
  const double count =
      static_cast<double>(backend->num_cost_evaluations() - count_before);
  const double kernels =
      seconds["initialise"] + seconds["update"] + seconds["median"];
  const double samples = count * kPatchSize / kernels;
  std::printf(
      "| %-18s | %6.1f | %6.1f | %6.2f | %7.1f | %6.2f | %5.1f %% | %5.1f %% | "
      "%5.1f %% |\n",
      variant.name,
      1e3 * kernels,
      1e3 * seconds["update"] / (2 * pass.num_iterations),
      1e3 * backend->longest_launch(),
      count / static_cast<double>(map.planes.size()),
      1e-9 * count / kernels,
      100 * samples / bounds.samples_per_second,
      100 * samples * kInstructionsPerSample / bounds.fp32_per_second,
      100 * GoodShare(map, problem.truth));
  std::fflush(stdout);
  return Json()
      .Add("variant", variant.name)
      .Add("kernel_seconds", kernels)
      .Add("seconds", AsJson(seconds))
      .Add("longest_launch_seconds", backend->longest_launch())
      .Add("ncc_per_pixel", count / static_cast<double>(map.planes.size()))
      .Add("ncc_per_second", count / kernels)
      .Add("share_of_texture_bound", samples / bounds.samples_per_second)
      .Add("share_of_fp32_bound",
           samples * kInstructionsPerSample / bounds.fp32_per_second)
      .Add("within_1_percent", GoodShare(map, problem.truth));
}

// The whole method on `num_images` copies of the image, `flight` at a time.
Json TimeMethod(const std::string& method,
                const SyntheticProblem& problem,
                int num_images,
                int flight) {
  const Camera& camera = problem.photometric.ref.camera;
  ScheduleOptions schedule_options;
  schedule_options.method = method;
  schedule_options.num_levels = AutomaticLevels(
      FindMethod(method), std::max(camera.width, camera.height));
  const Schedule schedule = MakeSchedule(schedule_options);
  std::vector<std::unique_ptr<CudaBackend>> backends;
  for (int i = 0; i < flight; ++i) {
    backends.push_back(MakeCudaBackend({}));
    const std::string failure = SelfTestFailure(backends.back().get());
    if (!failure.empty()) throw Error(ErrorCode::kDevice, failure);
  }
  std::mutex mutex;
  int next = 0;
  double good_share = 0, count = 0;
  PhaseTimes phases;
  std::map<std::string, double> kernels;
  const auto work = [&](CudaBackend* backend) {
    const CancelToken cancel;
    const RunControl control = {&cancel, nullptr, false};
    const std::map<std::string, double> before = backend->seconds();
    PhaseTimes times;
    for (;;) {
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (next == num_images) break;
        ++next;
      }
      HypothesisMap map(camera.width, camera.height);
      double image_count = 0;
      for (const StageSpec& stage : schedule.stages) {
        RunStage(backend,
                 stage.geometric ? problem.geometric : problem.photometric,
                 schedule,
                 stage,
                 MethodParams(),
                 control,
                 &map,
                 &times);
        image_count += static_cast<double>(backend->num_cost_evaluations());
      }
      backend->ConsistentViews(map, {0.1f, 0.05f, 1.0f, 2}, true, control);
      const std::lock_guard<std::mutex> lock(mutex);
      good_share = GoodShare(map, problem.truth);
      count = image_count;
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [name, value] : times) phases[name] += value;
    for (const auto& [name, value] : backend->seconds()) {
      const auto it = before.find(name);
      kernels[name] += value - (it == before.end() ? 0 : it->second);
    }
  };
  const Clock::time_point start = Clock::now();
  std::vector<std::thread> threads;
  std::vector<std::exception_ptr> failures(backends.size());
  for (size_t i = 0; i < backends.size(); ++i) {
    threads.emplace_back([&, i] {
      try {
        work(backends[i].get());
      } catch (...) {
        failures[i] = std::current_exception();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure != nullptr) std::rethrow_exception(failure);
  }
  const double seconds = SecondsSince(start) / num_images;
  for (auto* times : {&phases, &kernels}) {
    for (auto& [name, value] : *times) value /= num_images;
  }
  const double pixels = static_cast<double>(camera.width) * camera.height;
  std::printf("| %-8s | %2d | %d | %6.2f | %6.1f | %5.1f %% |",
              method.c_str(),
              static_cast<int>(problem.photometric.srcs.size()),
              flight,
              seconds,
              count / pixels,
              100 * good_share);
  for (const auto* times : {&phases, &kernels}) {
    for (const auto& [name, value] : *times) {
      std::printf(" %s %.3f", name.c_str(), value);
    }
    std::printf(" |");
  }
  std::printf("\n");
  std::fflush(stdout);
  return Json()
      .Add("method", method.c_str())
      .Add("srcs", static_cast<double>(problem.photometric.srcs.size()))
      .Add("images_in_flight", flight)
      .Add("seconds_per_image", seconds)
      .Add("ncc_per_pixel", count / pixels)
      .Add("within_1_percent", good_share)
      .Add("host_seconds_per_image", AsJson(phases))
      .Add("card_seconds_per_image", AsJson(kernels));
}

Json TimeSamplers(const ViewSet& views, const Bounds& bounds) {
  std::printf("\n| samples | 1e9/s, near | of bound | 1e9/s, spread |\n");
  std::printf("|---|---|---|---|\n");
  Json json;
  const std::pair<const char*, ImageFormat> formats[] = {
      {"byte", ImageFormat::kByte},
      {"half", ImageFormat::kHalf},
      {"float", ImageFormat::kFloat},
      {"quad", ImageFormat::kQuad}};
  for (const auto& [name, format] : formats) {
    for (const int log_tile_width : {3, 6}) {
      const double near = MeasureSampleRate(views, format, log_tile_width, 2);
      const double far = MeasureSampleRate(views, format, log_tile_width, 64);
      const std::string label =
          std::string(name) + (log_tile_width == 3 ? " 8x8" : " 64x1");
      std::printf("| %-10s | %7.1f | %5.1f %% | %7.1f |\n",
                  label.c_str(),
                  1e-9 * near,
                  100 * near / bounds.samples_per_second,
                  1e-9 * far);
      json.Add(label, Json().Add("near", near).Add("spread", far));
    }
  }
  return json;
}

std::vector<int> ReadList(const std::string& text) {
  std::vector<int> values;
  std::stringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) {
    values.push_back(std::stoi(item));
  }
  return values;
}

Settings ReadSettings(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--out")
      settings.out = value;
    else if (name == "--scene")
      settings.scene = value;
    else if (name == "--width")
      settings.width = std::stoi(value);
    else if (name == "--height")
      settings.height = std::stoi(value);
    else if (name == "--images")
      settings.images = std::stoi(value);
    else if (name == "--srcs")
      settings.srcs = ReadList(value);
    else if (name == "--flight")
      settings.flight = ReadList(value);
    else if (name == "--quick")
      settings.quick = value != "0";
    else
      throw Error(ErrorCode::kUsage, "unknown option " + name);
  }
  return settings;
}

int Main(int argc, char** argv) {
  const Settings settings = ReadSettings(argc, argv);
  std::string why_none;
  const std::vector<CudaDevice> devices = FindCudaDevices(&why_none);
  if (devices.empty()) {
    std::fprintf(stderr, "no GPU: %s\n", why_none.c_str());
    return 6;
  }
  const CudaDevice& device = devices[0];
  const Bounds bounds = BoundsOf(device);
  std::printf(
      "%s, compute capability %d.%d, %d processors, %.2f GHz, %s, "
      "%dx%d\n",
      device.name.c_str(),
      device.major,
      device.minor,
      device.num_processors,
      device.clock_ghz,
      settings.scene.c_str(),
      settings.width,
      settings.height);
  Json result;
  result.Add("card", device.name.c_str())
      .Add("processors", device.num_processors)
      .Add("clock_ghz", device.clock_ghz)
      .Add("texture_bound_samples_per_second", bounds.samples_per_second)
      .Add("fp32_bound_instructions_per_second", bounds.fp32_per_second)
      .Add("scene", settings.scene.c_str())
      .Add("width", settings.width)
      .Add("height", settings.height);
  const auto save = [&] {
    std::ofstream file(settings.out);
    file << result.Text() << "\n";
  };
  std::vector<Json> variants, methods;
  for (const int num_srcs : settings.srcs) {
    const SyntheticProblem problem = MakeSyntheticProblem(
        settings.scene, settings.width, settings.height, num_srcs);
    if (num_srcs == settings.srcs.front()) {
      result.Add("samplers", TimeSamplers(problem.photometric, bounds));
    }
    std::printf(
        "\n| basic pass, %d sources | kernels ms | half-sweep ms | "
        "longest launch ms | NCC/px | 1e9 NCC/s | of texture bound | "
        "of FP32 bound | within 1 %% |\n|---|---|---|---|---|---|---|---"
        "|---|\n",
        num_srcs);
    for (const Variant& variant : kVariants) {
      if (settings.quick && &variant != kVariants) continue;
      Json timed = TimeVariant(variant, problem, bounds);
      variants.push_back(timed.Add("srcs", num_srcs));
    }
    std::printf(
        "\n| method | sources | in flight | s/image | NCC/px | within 1 "
        "%% | host phases, s/image | card, s/image |\n|---|---|---|---|-"
        "--|---|---|---|\n");
    for (const char* method : {"hpm_plus", "hpm", "nesp"}) {
      for (const int flight : settings.flight) {
        methods.push_back(TimeMethod(method, problem, settings.images, flight));
      }
      if (settings.quick) break;
    }
  }
  result.Add("basic_pass", variants).Add("methods", methods);
  save();
  return 0;
}

}  // namespace
}  // namespace hpm

int main(int argc, char** argv) {
  try {
    return hpm::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
