#include "colmap_plugin/tool/signals.h"

#include <csignal>

#include <gtest/gtest.h>
#include <unistd.h>

namespace hpm {
namespace {

// Each body runs in a process of its own: handlers and the caught signal are
// global.
TEST(SignalsTest, FirstSignalCancelsAndIsRemembered) {
  EXPECT_EXIT(
      {
        const CancelToken& cancel = InstallSignalHandlers();
        const bool before = cancel.cancelled();
        raise(SIGTERM);
        _exit(!before && cancel.cancelled() && CaughtSignal() == SIGTERM ? 0
                                                                         : 1);
      },
      testing::ExitedWithCode(0),
      "");
}

TEST(SignalsTest, SecondSignalEndsTheProgramAtOnce) {
  EXPECT_EXIT(
      {
        InstallSignalHandlers();
        raise(SIGINT);
        raise(SIGTERM);
        _exit(0);
      },
      testing::ExitedWithCode(143),
      "");
}

TEST(SignalsTest, FullDiskAndClosedPipeDoNotKill) {
  EXPECT_EXIT(
      {
        InstallSignalHandlers();
        raise(SIGXFSZ);
        raise(SIGPIPE);
        _exit(0);
      },
      testing::ExitedWithCode(0),
      "");
}

}  // namespace
}  // namespace hpm
