// Times the kernels of the CUDA backend on a closed-form scene, by variant; see
// bench/gpu_bench.sh. Whole runs are timed by bench/gpu/runs.py.
//
//   hpm_gpu_bench --out results.json [--width 3200] [--height 2130]
//       [--srcs 10,20] [--scene depth_step] [--variants byte,quad]
//       [--samplers 0]
//
// --variants: those whose name begins with one of the words. The results are
// written after each step.
#include "bench/gpu/json.h"
#include "bench/gpu/sampler_rate.h"
#include "bench/synthetic_views.h"
#include "cuda/cuda_backend.h"
#include "cuda/cuda_devices.h"
#include "src/core/sampling_pattern.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace hpm {
namespace {

struct Settings {
  std::string out = "gpu.json", scene = "depth_step";
  int width = 3200, height = 2130;
  std::vector<int> srcs = {10, 20};
  std::vector<std::string> variants = {""};
  bool samplers = true;
};

struct Variant {
  const char* name;
  ImageFormat format;
  int log_tile_width;
};

const Variant kVariants[] = {
    {"byte 8x8", ImageFormat::kByte, 3},
    {"byte 16x4", ImageFormat::kByte, 4},
    {"byte 32x2", ImageFormat::kByte, 5},
    {"byte 64x1", ImageFormat::kByte, 6},
    {"quad 8x8", ImageFormat::kQuad, 3},
    {"quad 64x1", ImageFormat::kQuad, 6},
};

CudaOptions OptionsOf(const Variant& variant) {
  CudaOptions options;
  options.format = variant.format;
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
  backend->Run(pass, pattern, &map, {&cancel, nullptr});  // warm up
  const std::map<std::string, double> before = backend->DeviceSeconds();
  const uint64_t count_before = backend->num_cost_evaluations();
  map = HypothesisMap(camera.width, camera.height);
  backend->Run(pass, pattern, &map, {&cancel, nullptr});
  std::map<std::string, double> seconds = backend->DeviceSeconds();
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

Json TimeSamplers(const ViewSet& views, const Bounds& bounds) {
  std::printf("\n| samples | 1e9/s, near | of bound | 1e9/s, spread |\n");
  std::printf("|---|---|---|---|\n");
  Json json;
  const std::pair<const char*, ImageFormat> formats[] = {
      {"byte", ImageFormat::kByte}, {"quad", ImageFormat::kQuad}};
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

std::vector<std::string> ReadList(const std::string& text) {
  std::vector<std::string> words;
  std::stringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    words.push_back(word);
  }
  return words;
}

Settings ReadSettings(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--out") {
      settings.out = value;
    } else if (name == "--scene") {
      settings.scene = value;
    } else if (name == "--width") {
      settings.width = std::stoi(value);
    } else if (name == "--height") {
      settings.height = std::stoi(value);
    } else if (name == "--srcs") {
      settings.srcs.clear();
      for (const std::string& word : ReadList(value)) {
        settings.srcs.push_back(std::stoi(word));
      }
    } else if (name == "--variants") {
      settings.variants = ReadList(value);
    } else if (name == "--samplers") {
      settings.samplers = value != "0";
    } else {
      throw Error(ErrorCode::kUsage, "unknown option " + name);
    }
  }
  return settings;
}

bool IsAsked(const Settings& settings, const std::string& variant) {
  return std::any_of(
      settings.variants.begin(),
      settings.variants.end(),
      [&](const std::string& word) { return variant.rfind(word, 0) == 0; });
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
  std::vector<Json> variants;
  const auto save = [&] {
    Json whole = result;
    std::ofstream file(settings.out);
    file << whole.Add("basic_pass", variants).Text() << "\n";
  };
  for (const int num_srcs : settings.srcs) {
    const SyntheticProblem problem = MakeSyntheticProblem(
        settings.scene, settings.width, settings.height, num_srcs);
    if (settings.samplers && num_srcs == settings.srcs.front()) {
      result.Add("samplers", TimeSamplers(problem.photometric, bounds));
      save();
    }
    std::printf(
        "\n| basic pass, %d sources | kernels ms | half-sweep ms | "
        "longest launch ms | NCC/px | 1e9 NCC/s | of texture bound | "
        "of FP32 bound | within 1 %% |\n|---|---|---|---|---|---|---|---"
        "|---|\n",
        num_srcs);
    for (const Variant& variant : kVariants) {
      if (!IsAsked(settings, variant.name)) continue;
      Json timed = TimeVariant(variant, problem, bounds);
      variants.push_back(timed.Add("srcs", num_srcs));
      save();
    }
  }
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
