#include "src/gpu/self_test.h"

#include "src/cpu/cpu_backend.h"
#include "tests/gpu/emulated_backend.h"

#include <cmath>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(SelfTest, PassesOnBackendsThatWork) {
  EXPECT_EQ(SelfTestFailure(MakeCpuBackend("auto", 2).get()), "");
  EmulatedBackend texture({EmulatedCost::kTexture, 3, 16});
  EXPECT_EQ(SelfTestFailure(&texture), "");
}

// What a broken card does to the maps.
class BrokenBackend : public EmulatedBackend {
 public:
  using Break = void (*)(HypothesisMap*);
  explicit BrokenBackend(Break how)
      : EmulatedBackend({EmulatedCost::kQuad, 3, 16}), break_(how) {}
  void Run(const Pass& pass,
           const SamplingPattern& pattern,
           HypothesisMap* map,
           const RunControl& control) override {
    EmulatedBackend::Run(pass, pattern, map, control);
    break_(map);
  }

 private:
  Break break_;
};

TEST(SelfTest, FailsOnBackendsThatComputeRubbish) {
  const BrokenBackend::Break breaks[] = {
      // nothing was written
      [](HypothesisMap* map) { *map = HypothesisMap(map->width, map->height); },
      [](HypothesisMap* map) {
        for (Plane& plane : map->planes) plane.distance = NAN;
      },
      // a fifth of the image is off
      [](HypothesisMap* map) {
        for (size_t i = 0; i < map->planes.size(); i += 5) {
          map->planes[i].distance *= 1.05f;
        }
      }};
  for (const auto how : breaks) {
    BrokenBackend backend(how);
    EXPECT_THAT(SelfTestFailure(&backend), testing::HasSubstr("self-test"));
  }
}

TEST(SelfTest, ReportsWhatTheBackendThrows) {
  class Throwing : public EmulatedBackend {
   public:
    Throwing() : EmulatedBackend({}) {}
    void SetViews(const ViewSet&, const MethodParams&) override {
      throw Error(ErrorCode::kDevice, "no kernel image");
    }
  };
  Throwing backend;
  EXPECT_EQ(SelfTestFailure(&backend), "no kernel image");
}

}  // namespace
}  // namespace hpm
