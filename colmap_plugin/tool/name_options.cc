#include "colmap_plugin/tool/name_options.h"

#include "src/base/remedies.h"

#include <cstring>

namespace hpm {
namespace {

struct Named {
  const char* remedy;
  const char* option;
};

constexpr Named kNames[] = {
    {kSmallerImages, "--PatchMatchStereo.max_image_size"},
    {kFewerThreads, "--PatchMatchStereo.num_threads"},
    {kFewerImagesAtOnce, "--Hpm.gpu_images 1"},
    {kComputeOnCpu, "--Hpm.device cpu"},
    {kCpuTarget, "--Hpm.cpu_target"}};

}  // namespace

std::string NameOptions(std::string message) {
  for (const Named& named : kNames) {
    const size_t at = message.find(named.remedy);
    if (at == std::string::npos) continue;
    message.insert(at + std::strlen(named.remedy),
                   std::string(" (") + named.option + ")");
  }
  return message;
}

}  // namespace hpm
