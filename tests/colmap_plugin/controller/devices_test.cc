// Choice of the device with made-up GPUs, and what a run does when they fail.
#include "colmap_plugin/controller/devices.h"

#include "colmap_plugin/controller/run_budget.h"
#include "src/cpu/cpu_backend.h"
#include "src/engine/gpu_error.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ParseGpuIndexTest, ReadsListsAsColmap) {
  EXPECT_THAT(ParseGpuIndex("-1", 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(ParseGpuIndex("0,1", 2), ElementsAre(0, 1));
  EXPECT_THAT(ParseGpuIndex("1,1,0", 2), ElementsAre(1, 1, 0));
  try {
    ParseGpuIndex("0,2", 2);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kDevice);
    EXPECT_THAT(error.what(), HasSubstr("gpu_index 0,2"));
  }
}

// A GPU that is the CPU, or one that writes nothing.
class MadeUpGpu : public Backend {
 public:
  MadeUpGpu(int device, bool works)
      : device_(device), works_(works), cpu_(MakeCpuBackend("auto", 1)) {}
  std::string Name() const override { return "gpu " + std::to_string(device_); }
  uint64_t MemoryNeeded(int, int, int) const override { return 1; }
  void SetViews(const ViewSet& views, const MethodParams& params) override {
    cpu_->SetViews(views, params);
  }
  void Run(const Pass& pass,
           const SamplingPattern& pattern,
           HypothesisMap* map,
           const RunControl& control) override {
    if (!works_) return;
    // Only the self-test runs here, and it is always the same.
    static HypothesisMap solved;
    if (solved.planes.empty()) {
      cpu_->Run(pass, pattern, map, control);
      solved = *map;
    }
    *map = solved;
  }
  std::vector<float> Score(const std::vector<PixelPlane>& planes,
                           const RunControl& control) override {
    return cpu_->Score(planes, control);
  }
  std::vector<uint32_t> ConsistentViews(const HypothesisMap& map,
                                        const FilterParams& filter,
                                        bool geometric,
                                        const RunControl& control) override {
    return cpu_->ConsistentViews(map, filter, geometric, control);
  }
  uint64_t num_cost_evaluations() const override { return 0; }

 private:
  int device_;
  bool works_;
  std::unique_ptr<Backend> cpu_;
};

constexpr uint64_t kMegabyte = 1 << 20;

class DevicesTest : public testing::Test {
 protected:
  DevicesTest() {
    gpus_.find = [this](std::string* why_none) {
      *why_none = "made-up reason";
      return devices_;
    };
    gpus_.open = [this](int device) -> std::unique_ptr<Backend> {
      if (refuse_.count(device) > 0) {
        throw GpuError(ErrorCode::kDevice, "does not open");
      }
      return std::make_unique<MadeUpGpu>(device, broken_.count(device) == 0);
    };
  }

  void AddGpu(uint64_t megabytes) {
    const int index = static_cast<int>(devices_.size());
    devices_.push_back({index,
                        "made-up",
                        9,
                        0,
                        1,
                        1.0,
                        megabytes * kMegabyte,
                        megabytes * kMegabyte});
  }

  std::vector<std::string> Open(const std::string& device,
                                const std::string& gpu_index,
                                int num_images = 100,
                                int num_threads = 2) {
    ControllerOptions options;
    options.hpm.device = device;
    options.patch_match.gpu_index = gpu_index;
    std::vector<std::string> names;
    for (const auto& backend :
         OpenGpus(options,
                  {1000, 1000, 1000, 1000, 10, true},
                  num_images,
                  num_threads,
                  gpus_,
                  [this](LogLevel level, const std::string&line) {
                    lines_.push_back((level == LogLevel::kInfo ? "I " : "W ") +
                                     line);
                  })) {
      names.push_back(backend->Name());
    }
    return names;
  }

  void ExpectError(const std::string& device,
                   ErrorCode code,
                   const std::string& part) {
    try {
      Open(device, "-1");
      FAIL() << part;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      EXPECT_THAT(error.what(), HasSubstr(part));
    }
  }

  std::vector<CudaDevice> devices_;
  std::set<int> broken_, refuse_;
  GpuAccess gpus_;
  std::vector<std::string> lines_;
};

TEST_F(DevicesTest, WithoutGpuAutoSaysSoInOneLineAndCudaIsAnError) {
  EXPECT_TRUE(Open("auto", "-1").empty());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("made-up reason")));
  ExpectError("cuda", ErrorCode::kDevice, "made-up reason");
}

TEST_F(DevicesTest, TheCpuIsNotAskedAboutGpus) {
  AddGpu(1 << 16);
  EXPECT_TRUE(Open("cpu", "-1").empty());
  EXPECT_TRUE(lines_.empty());
}

TEST_F(DevicesTest, EveryEntryGetsItsImagesInFlight) {
  AddGpu(1 << 16);
  AddGpu(1 << 16);
  EXPECT_THAT(
      Open("auto", "-1"),
      ElementsAre("gpu 0", "gpu 1", "gpu 0", "gpu 1", "gpu 0", "gpu 1"));
  EXPECT_EQ(Open("auto", "1").size(), 3u);
  EXPECT_EQ(Open("auto", "1,1").size(), 6u);
  EXPECT_EQ(Open("auto", "-1", 1).size(), 1u);
  EXPECT_THAT(Open("auto", "-1", 2), ElementsAre("gpu 0", "gpu 1"));
  EXPECT_EQ(Open("auto", "0", 100, 12).size(), 6u);
  EXPECT_EQ(Open("auto", "-1", 100, 16).size(), 8u);
  EXPECT_EQ(Open("auto", "0", 100, 96).size(), 8u);
  EXPECT_TRUE(lines_.empty());
}

TEST_F(DevicesTest, ASmallGpuGetsFewerImagesOrNone) {
  AddGpu(400);
  EXPECT_THAT(Open("auto", "-1"), ElementsAre("gpu 0", "gpu 0"));
  devices_[0].free_bytes = 20 * kMegabyte;
  EXPECT_TRUE(Open("auto", "-1").empty());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("W GPU 0")));
  ExpectError("cuda", ErrorCode::kOutOfResources, "20 MB are free");
}

TEST_F(DevicesTest, AGpuThatFailsTheSelfTestIsRefused) {
  AddGpu(1 << 16);
  AddGpu(1 << 16);
  broken_ = {0};
  EXPECT_THAT(Open("auto", "-1"), ElementsAre("gpu 1", "gpu 1", "gpu 1"));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("self-test")));
  ExpectError("cuda", ErrorCode::kDevice, "self-test");
  broken_ = {};
  refuse_ = {0, 1};
  EXPECT_TRUE(Open("auto", "-1").empty());
  ExpectError("cuda", ErrorCode::kDevice, "does not open");
}

TEST(CpuImagesInFlight, ASecondImageOnlyWhereItCostsLittle) {
  const uint64_t mib = 1 << 20;
  const MemoryNeeds small = {100 * mib, 50 * mib};
  EXPECT_EQ(CpuImagesInFlight(small, 4, 1000 * mib), 2);
  EXPECT_EQ(CpuImagesInFlight(small, 2, 1000 * mib), 1);
  EXPECT_EQ(CpuImagesInFlight(small, 4, 300 * mib), 1);
  const MemoryNeeds large = {500 * mib, 50 * mib};
  EXPECT_EQ(CpuImagesInFlight(large, 4, 100000 * mib), 1);
}

}  // namespace
}  // namespace hpm
