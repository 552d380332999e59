#include "colmap_plugin/controller/run_resources.h"

#include "colmap_plugin/controller/devices.h"
#include "colmap_plugin/controller/run_budget.h"
#include "src/cpu/cpu_backend.h"
#include "src/engine/memory_plan.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace hpm {

RunResources OpenResources(const Workspace& workspace,
                           const std::vector<StereoProblem>& problems,
                           const ControllerOptions& options,
                           const CpuTarget& target,
                           int num_threads,
                           const LogSink& log) {
  const bool geometric = options.patch_match.geom_consistency;
  std::vector<std::unique_ptr<Backend>> cpus;
  cpus.push_back(MakeCpuBackend(target, num_threads));
  std::vector<std::unique_ptr<Backend>> gpus =
      OpenGpus(options,
               LargestProblem(workspace, problems, geometric),
               static_cast<int>(problems.size()),
               num_threads,
               RealGpus(),
               log);
  const bool may_fall_back = options.hpm.device != "cuda";
  std::vector<const Backend*> backends;
  if (!gpus.empty()) backends.push_back(gpus.front().get());
  if (gpus.empty() || may_fall_back) backends.push_back(cpus.front().get());
  RunResources resources;
  resources.backend_name = backends.front()->Name();
  MemoryNeeds needs = LargestNeeds(workspace, problems, backends, geometric);
  if (gpus.size() > 1) {
    gpus.resize(
        ImagesInMemory(needs, static_cast<int>(gpus.size()), MemoryLimit()));
  } else if (gpus.empty() &&
             CpuImagesInFlight(needs, num_threads, MemoryLimit()) > 1) {
    cpus.push_back(MakeCpuBackend(target, num_threads));
  }
  const int num_decodes = DecodesAtOnce(needs);
  const size_t num_in_flight = std::max(cpus.size(), gpus.size());
  needs.working *= num_in_flight;
  needs.inputs *= num_in_flight;
  const uint64_t cache_bytes =
      PlanCacheBytes(CacheBytes(options.patch_match.cache_size),
                     needs.working,
                     needs.inputs,
                     MemoryLimit());
  resources.inputs =
      std::make_unique<InputCache>(workspace, cache_bytes, num_decodes);
  log(LogLevel::kInfo,
      fmt::format("{}{}, method {}, about {} MB of memory",
                  resources.backend_name,
                  num_in_flight > 1
                      ? fmt::format(", {} images in flight", num_in_flight)
                      : "",
                  options.hpm.method,
                  (kUsualOverheadBytes + needs.working + needs.inputs) >> 20));
  resources.workers = std::make_unique<WorkerPool>(
      std::move(cpus), std::move(gpus), may_fall_back, log);
  return resources;
}

}  // namespace hpm
