#include "src/base/platform/memory.h"
#include "src/base/platform/pages.h"
#include "src/base/platform/terminal.h"
#include "src/base/threads.h"

#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>
#ifndef _WIN32
#include <fcntl.h>
#include <unistd.h>
#endif

namespace hpm {
namespace {

TEST(Memory, IsKnown) {
  EXPECT_GT(PhysicalMemoryBytes(), uint64_t{64} << 20);
  EXPECT_GT(AddressSpaceLimit(), uint64_t{64} << 20);
  EXPECT_GT(PeakMemoryBytes(), uint64_t{256} << 10);
  EXPECT_LT(PeakMemoryBytes(), PhysicalMemoryBytes());
}

TEST(Memory, ThePeakGrowsByWhatIsUsed) {
  const uint64_t before = PeakMemoryBytes();
  constexpr size_t kBytes = size_t{64} << 20;
  void* memory = AllocateAligned(4096, kBytes);
  ASSERT_NE(memory, nullptr);
  std::memset(memory, 1, kBytes);
  EXPECT_GE(PeakMemoryBytes(), before + kBytes / 2);
  FreeAligned(memory);
}

TEST(Memory, IsAlignedAndMayWishForHugePages) {
  constexpr size_t kAlignment = size_t{2} << 20;
  void* memory = AllocateAligned(kAlignment, 2 * kAlignment);
  ASSERT_NE(memory, nullptr);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(memory) % kAlignment, 0u);
  WishHuge(memory, 2 * kAlignment);
  std::memset(memory, 1, 2 * kAlignment);
  FreeAligned(memory);
}

TEST(Threads, AFewCanBeStarted) {
  EXPECT_EQ(CountStartableThreads(3, 1 << 20, 1 << 20), 3);
}

#ifndef _WIN32
TEST(StandardStreams, ClosedOnesAreOpened) {
  EXPECT_EXIT(
      {
        close(STDIN_FILENO);
        close(STDOUT_FILENO);
        OpenStandardStreams();
        const int next = open("/dev/null", O_RDONLY);
        _exit(fcntl(STDIN_FILENO, F_GETFD) != -1 &&
                      fcntl(STDOUT_FILENO, F_GETFD) != -1 &&
                      next > STDERR_FILENO && TerminalColumns() == 0 &&
                      !IsStandardOutputATerminal()
                  ? 0
                  : 1);
      },
      testing::ExitedWithCode(0),
      "");
}
#endif

}  // namespace
}  // namespace hpm
