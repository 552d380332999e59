#include "python/src/estimate.h"

#include "colmap_plugin/options/method_options.h"
#include "python/src/background_run.h"
#include "python/src/options.h"
#include "python/src/progress.h"
#include "src/core/rng.h"
#include "src/cpu/cpu_backend.h"
#include "src/engine/memory_stores.h"
#include "src/engine/method.h"
#include "src/engine/run_schedule.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace hpm {
namespace {

using Pixels =
    nb::ndarray<const uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <nb::ssize_t... Shape>
using Numbers = nb::
    ndarray<const double, nb::shape<Shape...>, nb::c_contig, nb::device::cpu>;
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// All of image i stands in row i.
struct Views {
  std::vector<GrayImage> images;
  Numbers<-1, 3, 3> k, r;
  Numbers<-1, 3> t;

  Eigen::Map<const Matrix3> K(int i) const {
    return Eigen::Map<const Matrix3>(k.data() + 9 * i);
  }
  Eigen::Map<const Matrix3> R(int i) const {
    return Eigen::Map<const Matrix3>(r.data() + 9 * i);
  }
  Eigen::Map<const Eigen::Vector3d> T(int i) const {
    return Eigen::Map<const Eigen::Vector3d>(t.data() + 3 * i);
  }

  // In the world frame moved so that the camera of image `origin` is its
  // origin: single precision has no digits to spare.
  Camera CameraAround(int i, int origin) const {
    const Eigen::Vector3d center = -R(origin).transpose() * T(origin);
    const Eigen::Vector3d moved =
        i == origin ? Eigen::Vector3d::Zero() : (R(i) * center + T(i)).eval();
    Camera camera;
    camera.width = images[i].width;
    camera.height = images[i].height;
    camera.fx = static_cast<float>(K(i)(0, 0));
    camera.fy = static_cast<float>(K(i)(1, 1));
    // From COLMAP's pixel centres, at +0.5, to the library's.
    camera.cx = static_cast<float>(K(i)(0, 2) - 0.5);
    camera.cy = static_cast<float>(K(i)(1, 2) - 0.5);
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col)
        camera.R.m[3 * row + col] = static_cast<float>(R(i)(row, col));
    }
    camera.t = {static_cast<float>(moved.x()),
                static_cast<float>(moved.y()),
                static_cast<float>(moved.z())};
    return camera;
  }
};

std::vector<Problem> Problems(const Views& views,
                              const std::vector<std::vector<int>>& sources,
                              const Numbers<-1, 2>& depth_ranges,
                              int seed) {
  std::vector<Problem> problems;
  for (int i = 0; i < static_cast<int>(sources.size()); ++i) {
    if (sources[i].empty()) continue;
    Problem problem;
    problem.image = i;
    problem.camera = views.CameraAround(i, i);
    for (const int j : sources[i])
      problem.sources.push_back({j, views.CameraAround(j, i)});
    problem.depth_min = static_cast<float>(depth_ranges(i, 0));
    problem.depth_max = static_cast<float>(depth_ranges(i, 1));
    problem.random_key = CombineBits(static_cast<uint64_t>(seed), i);
    problems.push_back(problem);
  }
  return problems;
}

RunSpec MakeSpec(ControllerOptions options, std::vector<Problem> problems) {
  int side = 1;
  for (const Problem& problem : problems)
    side = std::max({side, problem.camera.width, problem.camera.height});
  if (options.hpm.num_levels <= 0) {
    options.hpm.num_levels =
        AutomaticLevels(FindMethod(options.hpm.method), side);
  }
  return {MakeSchedule(MakeScheduleOptions(options)),
          MakeMethodParams(options),
          MakeMapFilter(options),
          std::move(problems)};
}

// Depths and normals of an image, both row-major.
struct Result {
  std::vector<float> depth, normal;
};

Result ResultOf(const HypothesisMap& map, const Problem& problem) {
  Result result;
  result.depth.assign(map.planes.size(), 0);
  result.normal.assign(3 * map.planes.size(), 0);
  size_t i = 0;
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col, ++i) {
      const Plane& plane = map.planes[i];
      if (!(plane.distance > 0)) continue;
      const float z = DepthAt(problem.camera,
                              plane,
                              static_cast<float>(col),
                              static_cast<float>(row));
      if (!(z >= problem.depth_min && z <= problem.depth_max)) continue;
      result.depth[i] = z;
      result.normal[3 * i] = plane.normal.x;
      result.normal[3 * i + 1] = plane.normal.y;
      result.normal[3 * i + 2] = plane.normal.z;
    }
  }
  return result;
}

nb::object ArrayOf(std::vector<float> values, std::vector<size_t> shape) {
  auto* kept = new std::vector<float>(std::move(values));
  const nb::capsule owner(kept, [](void* pointer) noexcept {
    delete static_cast<std::vector<float>*>(pointer);
  });
  return nb::cast(nb::ndarray<nb::numpy, float>(
      kept->data(), shape.size(), shape.data(), owner));
}

RunEvents EventsTo(const ProgressSink& progress,
                   const RunSpec& spec,
                   const CancelToken& cancel) {
  RunEvents events;
  events.cancel = &cancel;
  const size_t num_stages = spec.schedule.stages.size();
  events.progress = [&progress, &spec, num_stages](const RunProgress& at) {
    const StageSpec& stage = spec.schedule.stages[at.stage];
    ProgressEvent event;
    event.stage = stage.geometric ? "geometric" : "photometric";
    event.title = fmt::format("stage {} of {}", at.stage + 1, num_stages);
    if (at.problem >= 0)
      event.image = std::to_string(spec.problems[at.problem].image);
    event.image_number = at.number;
    event.num_images = at.num_problems;
    event.fraction = at.fraction;
    progress(event);
  };
  return events;
}

// One entry per image: a pair of arrays, None without sources.
nb::list Estimate(const std::vector<Pixels>& images,
                  const Numbers<-1, 3, 3>& k,
                  const Numbers<-1, 3, 3>& r,
                  const Numbers<-1, 3>& t,
                  const std::vector<std::vector<int>>& sources,
                  const Numbers<-1, 2>& depth_ranges,
                  const PatchMatchOptions& given,
                  nb::handle progress) {
  const ControllerOptions options =
      ParsedFrom(given, {"--workspace_path=."}, nullptr);
  CheckCallback(progress);
  Views views = {{}, k, r, t};
  for (const Pixels& pixels : images) {
    GrayImage image;
    image.width = static_cast<int>(pixels.shape(1));
    image.height = static_cast<int>(pixels.shape(0));
    image.data.assign(pixels.data(), pixels.data() + pixels.size());
    views.images.push_back(std::move(image));
  }
  const RunSpec spec = MakeSpec(
      options, Problems(views, sources, depth_ranges, options.random_seed));

  std::vector<Result> results;
  RunInBackground([&](const CancelToken& cancel, const Post& post) {
    if (spec.problems.empty()) return;
    MemoryImageStore pictures(std::move(views.images));
    MemoryMapStore maps(spec.problems);
    WorkerPool workers(MakeCpuBackend(options.hpm.cpu_target,
                                      options.patch_match.num_threads));
    const ProgressSink sink = ProgressTo(progress, post);
    RunSchedule(spec, &pictures, &maps, &workers, EventsTo(sink, spec, cancel));
    for (size_t p = 0; p < spec.problems.size(); ++p) {
      results.push_back(
          ResultOf(*maps.map(static_cast<int>(p)), spec.problems[p]));
    }
  });

  nb::list list;
  size_t p = 0;
  for (size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].empty()) {
      list.append(nb::none());
      continue;
    }
    const Camera& camera = spec.problems[p].camera;
    const auto width = static_cast<size_t>(camera.width);
    const auto height = static_cast<size_t>(camera.height);
    Result& result = results[p++];
    list.append(
        nb::make_tuple(ArrayOf(std::move(result.depth), {height, width}),
                       ArrayOf(std::move(result.normal), {height, width, 3})));
  }
  return list;
}

}  // namespace

void BindEstimate(nb::module_& module) {
  module.def("estimate",
             Estimate,
             nb::arg("images"),
             nb::arg("K"),
             nb::arg("R"),
             nb::arg("t"),
             nb::arg("sources"),
             nb::arg("depth_ranges"),
             nb::arg("options"),
             nb::arg("progress").none(),
             "hpm_mvs.estimate() of arrays that are checked.");
}

}  // namespace hpm
