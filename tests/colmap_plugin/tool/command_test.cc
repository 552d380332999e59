#include "colmap_plugin/tool/dispatch.h"
#include "colmap_plugin/tool/help.h"
#include "src/base/error.h"
#include "src/base/retries.h"

#include <cerrno>
#include <new>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class CommandTest : public testing::Test {
 protected:
  int Run(const std::vector<std::string>& arguments) {
    return RunTool(arguments,
                   {&out_,
                    &err_,
                    /*terminal=*/false,
                    80,
                    [] { return 0.0; },
                    &cancel_,
                    [this](const ControllerOptions& options,
                           const LogSink& log,
                           const ProgressSink&,
                           const CancelToken&) {
                      ++num_runs_;
                      options_ = options;
                      log(LogLevel::kInfo, "Reading workspace...");
                      if (action_) action_();
                      return summary_;
                    },
                    {{"check", [this](const CommandCall& call) {
                        options_ = call.options;
                        own_ = call.own;
                        ++num_runs_;
                        if (action_) action_();
                        return call.print("one finding\n");
                      }}}});
  }

  int RunThrowing(std::function<void()> action) {
    action_ = std::move(action);
    return Run({"patch_match_stereo", "--workspace_path", "w"});
  }

  CancelToken cancel_;
  std::function<void()> action_;
  RunSummary summary_;
  ControllerOptions options_;
  CommandOptions own_;
  int num_runs_ = 0;
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST_F(CommandTest, GoodRunReturnsZeroAndSaysElapsedTimeLikeColmap) {
  summary_.seconds = 90;
  EXPECT_EQ(
      Run({"patch_match_stereo", "--workspace_path", "w", "--random_seed=4"}),
      0);
  EXPECT_EQ(options_.workspace.path, "w");
  EXPECT_EQ(options_.random_seed, 4);
  EXPECT_THAT(out_.str(),
              AllOf(HasSubstr("\nReading workspace...\n"),
                    HasSubstr("\nElapsed time: 1.500 [minutes]\n")));
  EXPECT_THAT(err_.str(), IsEmpty());
}

TEST_F(CommandTest, AllCommandsTellRetriesAndHearTheSignalMeanwhile) {
  for (const char* command : {"patch_match_stereo", "check"}) {
    action_ = [] {
      const std::filesystem::path path = "some.file";
      Retries retries(path);
      EXPECT_TRUE(retries.Again(EIO));
    };
    EXPECT_EQ(Run({command, "--workspace_path", "w"}), 0);
    EXPECT_THAT(out_.str() + err_.str(),
                HasSubstr("some.file: Input/output error; trying again in"))
        << command;
    out_.str("");
    err_.str("");
  }
  cancel_.Cancel();
  EXPECT_EQ(Run({"check", "--workspace_path", "w"}),
            static_cast<int>(ErrorCode::kInterrupted));
}

TEST_F(CommandTest, CommandWordMayBeLeftOut) {
  EXPECT_EQ(Run({"--workspace_path", "w"}), 0);
  EXPECT_EQ(num_runs_, 1);
}

TEST_F(CommandTest, WrongOptionsReturnTwoAndRunNothing) {
  EXPECT_EQ(
      Run({"--PatchMatchStereo.window_radius", "0", "--workspace_path", "w"}),
      2);
  EXPECT_EQ(num_runs_, 0);
  EXPECT_EQ(err_.str(),
            "ERROR: --PatchMatchStereo.window_radius '0' is not allowed; "
            "allowed: int, 1 to 32\n");
}

TEST_F(CommandTest, UnknownCommandReturnsTwoWithTheList) {
  EXPECT_EQ(Run({"stereo_fusion", "--workspace_path", "w"}), 2);
  EXPECT_EQ(num_runs_, 0);
  EXPECT_EQ(err_.str(),
            "ERROR: unknown command 'stereo_fusion'; commands: " +
                CommandNames(", ") + "\n");
  EXPECT_THAT(err_.str(), HasSubstr("patch_match_stereo, "));
  EXPECT_EQ(Run({"help", "stereo_fusion"}), 2);
}

TEST_F(CommandTest, HelpAndVersionGoToStandardOutput) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{
           {},
           {"help"},
           {"--help"},
           {"-h"},
           {"patch_match_stereo", "--workspace_path", "w", "-h"}}) {
    out_.str("");
    EXPECT_EQ(Run(arguments), 0);
    EXPECT_EQ(out_.str(), HelpText());
  }
  for (const char* word : {"version", "--version"}) {
    out_.str("");
    EXPECT_EQ(Run({word}), 0);
    EXPECT_EQ(out_.str(), VersionLine() + "\n");
  }
  out_.str("");
  EXPECT_EQ(Run({"help", "--markdown"}), 0);
  EXPECT_EQ(out_.str(), OptionsMarkdown());
  EXPECT_THAT(err_.str(), IsEmpty());
  EXPECT_EQ(num_runs_, 0);
}

TEST_F(CommandTest, OtherCommandsTakeTheirOwnOptionsAndThoseOfARun) {
  EXPECT_EQ(Run({"check",
                 "--workspace_path=w",
                 "--fix",
                 "Yes",
                 "--PatchMatchStereo.max_image_size",
                 "100"}),
            0);
  EXPECT_EQ(num_runs_, 1);
  EXPECT_TRUE(own_.fix);
  EXPECT_EQ(options_.workspace.path, "w");
  EXPECT_EQ(options_.workspace.max_image_size, 100);
  EXPECT_EQ(out_.str(), "one finding\n");
  // A unique beginning is enough.
  EXPECT_EQ(Run({"check", "--workspace_pa=v", "--fi=0"}), 0);
  EXPECT_FALSE(own_.fix);
  EXPECT_EQ(options_.workspace.path, "v");
  EXPECT_EQ(err_.str(), "");
}

TEST_F(CommandTest, OtherCommandsNameAllProblemsOfTheirOptions) {
  EXPECT_EQ(Run({"check",
                 "--fix=maybe",
                 "--fix=1",
                 "--Hpm.method=magic",
                 "--depth=2",
                 "--fix"}),
            2);
  EXPECT_EQ(num_runs_, 0);
  EXPECT_THAT(err_.str(),
              AllOf(HasSubstr("--fix 'maybe' is not allowed"),
                    HasSubstr("--fix is given twice"),
                    HasSubstr("--fix has no value"),
                    HasSubstr("--Hpm.method 'magic'"),
                    HasSubstr("'--depth=2'"),
                    HasSubstr("'--workspace_path' is required")));
}

TEST_F(CommandTest, OtherCommandsHaveTheirOwnHelp) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{
           {"help", "check"}, {"check", "--help"}, {"check", "-h"}}) {
    out_.str("");
    EXPECT_EQ(Run(arguments), 0);
    EXPECT_EQ(out_.str(), CommandHelp(*FindCommand("check")));
  }
  out_.str("");
  EXPECT_EQ(Run({"help", "patch_match_stereo"}), 0);
  EXPECT_EQ(out_.str(), HelpText());
  EXPECT_EQ(num_runs_, 0);
}

TEST_F(CommandTest, ErrorsOfOtherCommandsAreExitCodesToo) {
  action_ = [] { throw Error(ErrorCode::kBadInput, "x.bin: bad"); };
  EXPECT_EQ(Run({"check", "--workspace_path", "w"}), 3);
  EXPECT_EQ(err_.str(), "ERROR: x.bin: bad\n");
}

TEST_F(CommandTest, FailedImagesReturnFourAndAreNamed) {
  summary_.num_problems = 3;
  summary_.failed = {"a.jpg", "b.jpg"};
  EXPECT_EQ(Run({"--workspace_path", "w"}), 4);
  EXPECT_THAT(err_.str(),
              StartsWith("ERROR: 2 of 3 images failed: a.jpg, b.jpg"));
}

TEST_F(CommandTest, EachErrorCodeIsTheExitCodeWithOneErrorLine) {
  for (const int code : {1, 2, 3, 5, 6, 7}) {
    err_.str("");
    EXPECT_EQ(RunThrowing([code] {
                throw Error(static_cast<ErrorCode>(code), "x.bin: bad\nfile");
              }),
              code);
    EXPECT_EQ(err_.str(), "ERROR: x.bin: bad file\n");
  }
}

TEST_F(CommandTest, InterruptedRunReturns130AndSaysHowToGoOn) {
  EXPECT_EQ(RunThrowing([this] {
              cancel_.Cancel();
              cancel_.ThrowIfCancelled();
            }),
            130);
  EXPECT_THAT(err_.str(), HasSubstr("same command again"));
}

TEST_F(CommandTest, LackOfMemoryReturnsFiveWithAdvice) {
  EXPECT_EQ(RunThrowing([] { throw std::bad_alloc(); }), 5);
  EXPECT_THAT(err_.str(),
              AllOf(HasSubstr("cache_size"), HasSubstr("max_image_size")));
}

TEST_F(CommandTest, ForeignExceptionReturnsOne) {
  EXPECT_EQ(RunThrowing([] { throw std::runtime_error("odd"); }), 1);
  EXPECT_EQ(err_.str(), "ERROR: odd\n");
}

TEST_F(CommandTest, OptionWithoutEffectIsNotedOnce) {
  EXPECT_EQ(
      Run({"--workspace_path", "w", "--PatchMatchStereo.ncc_sigma", "0.5"}), 0);
  const std::string note = "--PatchMatchStereo.ncc_sigma has no effect here";
  const std::string log = out_.str() + err_.str();
  const size_t first = log.find(note);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(log.find(note, first + 1), std::string::npos);
}

}  // namespace
}  // namespace hpm
