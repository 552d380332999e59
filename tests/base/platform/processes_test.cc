#include "src/base/platform/processes.h"

#include "tests/base/scratch_folder.h"

#include <cerrno>
#include <cstdlib>

#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/wait.h>
#include <unistd.h>
#endif

namespace hpm {
namespace {

TEST(Processes, ThisProgramIsTheOneThatRuns) {
  const std::filesystem::path program = ThisProgram();
  EXPECT_EQ(program.stem(), "platform_test");
  EXPECT_TRUE(IsExecutable(program));
}

TEST(Processes, WhatCannotBeRunIsNotExecutable) {
  const ScratchFolder folder;
  EXPECT_FALSE(IsExecutable(folder / "none"));
#ifndef _WIN32
  WriteFile(folder / "text", "x");
  EXPECT_FALSE(IsExecutable(folder / "text"));
#endif
}

TEST(Processes, ThisOneIsAlive) {
  const ProcessStatus status = StatusOfProcess(ThisProcessId());
  EXPECT_EQ(status.state, ProcessState::kAlive);
  EXPECT_GT(status.start_time, 0u);
  EXPECT_EQ(status.start_time, StatusOfProcess(ThisProcessId()).start_time);
}

TEST(Processes, NumbersThatAreNoneAreGone) {
  for (const int64_t id : {int64_t{0}, int64_t{-1}, (int64_t{1} << 32) + 1})
    EXPECT_EQ(StatusOfProcess(id).state, ProcessState::kGone) << id;
}

TEST(Processes, TheMachineHasAName) { EXPECT_NE(HostName(), ""); }

TEST(Processes, BootIdAndNamespaceStayTheSame) {
  EXPECT_EQ(BootId(), BootId());
  EXPECT_EQ(ProcessNamespace(), ProcessNamespace());
#ifdef __linux__
  EXPECT_EQ(BootId().size(), 36u);
  EXPECT_NE(ProcessNamespace(), "");
#endif
}

#ifndef _WIN32
TEST(Processes, AnotherIsAliveThenEndedThenGone) {
  int gate[2];
  ASSERT_EQ(pipe(gate), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(gate[1]);
    char byte;
    _exit(read(gate[0], &byte, 1) == 0 ? 0 : 1);
  }
  close(gate[0]);
  EXPECT_EQ(StatusOfProcess(child).state, ProcessState::kAlive);
  close(gate[1]);
  siginfo_t info;
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT),
            0);
  EXPECT_EQ(StatusOfProcess(child).state, ProcessState::kEnded);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_EQ(StatusOfProcess(child).state, ProcessState::kGone);
}

TEST(Processes, AnotherProgramTakesThePlaceOfThisOne) {
  std::string words[] = {"this", "-c", "exit \"$0\"", "7"};
  char* argv[] = {words[0].data(),
                  words[1].data(),
                  words[2].data(),
                  words[3].data(),
                  nullptr};
  EXPECT_EXIT(
      ReplaceThisProgram("/bin/sh", argv), testing::ExitedWithCode(7), "");
}
#endif

TEST(Processes, WhatCannotBeStartedIsAnError) {
  const ScratchFolder folder;
  std::string word = "this";
  char* argv[] = {word.data(), nullptr};
  errno = 0;
  EXPECT_EQ(ReplaceThisProgram(folder / "none", argv), -1);
  EXPECT_EQ(errno, ENOENT);
}

}  // namespace
}  // namespace hpm
