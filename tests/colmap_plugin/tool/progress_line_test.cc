#include "colmap_plugin/tool/progress_line.h"

#include "tests/colmap_plugin/tool/comma_locale.h"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

ProgressEvent Event(const std::string& image, int number, double fraction) {
  return {"photometric", image, number, 10, fraction, ""};
}

class ProgressLineTest : public testing::Test {
 protected:
  ProgressLine Make(bool terminal, int columns = 200) {
    return ProgressLine(
        &out_, &err_, terminal, columns, [this] { return now_; });
  }

  double now_ = 1000;
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST(EtaEstimatorTest, IsExactForSteadyWork) {
  EtaEstimator eta;
  eta.Update(50, 0);
  EXPECT_LT(eta.Remaining(50), 0);
  for (int i = 1; i <= 10; ++i) {
    eta.Update(50 + 20 * i, 0.1 * i);
    EXPECT_NEAR(eta.Remaining(50 + 20 * i), 200 - 20 * i, 1e-9);
  }
  EXPECT_NEAR(eta.Remaining(260), 0, 1e-9);
}

TEST(EtaEstimatorTest, CountsOnlyWorkSinceTheStart) {
  EtaEstimator eta;
  eta.Update(0, 0.5);
  eta.Update(10, 0.6);
  EXPECT_NEAR(eta.Remaining(10), 40, 1e-9);
}

TEST(EtaEstimatorTest, OneSlowImageMovesTheEndByAPartOnly) {
  EtaEstimator eta;
  eta.Update(0, 0);
  eta.Update(10, 0.1);  // end at 100
  eta.Update(40, 0.2);  // alone: end at 200
  EXPECT_GT(40 + eta.Remaining(40), 100);
  EXPECT_LT(40 + eta.Remaining(40), 150);
}

TEST_F(ProgressLineTest, TerminalLineIsRewrittenInPlace) {
  ProgressLine line = Make(true);
  line.Update(Event("a.jpg", 0, 0));
  now_ += 100;
  line.Update(Event("b.jpg", 1, 0.1));
  EXPECT_EQ(out_.str(),
            "[  0%] photometric: image 0/10, a.jpg"
            "\r\033[K"
            "[ 10%] photometric: image 1/10, 15 min 00 s left, b.jpg");
  line.Close();
  EXPECT_THAT(out_.str(), EndsWith("\r\033[K"));
}

TEST_F(ProgressLineTest, MessageGoesAboveTheLineOnATerminal) {
  ProgressLine line = Make(true);
  line.Update(Event("a.jpg", 1, 0.1));
  line.Log(LogLevel::kInfo, "hello");
  EXPECT_EQ(out_.str(),
            "[ 10%] photometric: image 1/10, a.jpg"
            "\r\033[Khello\n"
            "[ 10%] photometric: image 1/10, a.jpg");
}

TEST_F(ProgressLineTest, TerminalLineFitsTheWidthAndKeepsCharactersWhole) {
  for (int columns = 1; columns < 60; ++columns) {
    out_.str("");
    ProgressLine line = Make(true, columns);
    line.Update(Event("\xc3\xa4\xc3\xa4\xc3\xa4.jpg", 1, 0.1));
    const std::string text = out_.str();
    EXPECT_LE(text.size(), static_cast<size_t>(std::max(columns - 1, 1)));
    EXPECT_NE(static_cast<unsigned char>(text.back()), 0xc3) << columns;
  }
}

TEST_F(ProgressLineTest, PlainLinesComeAtStageEndsAndEveryHalfMinute) {
  ProgressLine line = Make(false);
  line.Update(Event("a.jpg", 1, 0.1));  // first of the stage
  now_ += 29;
  line.Update(Event("b.jpg", 2, 0.2));  // too early
  now_ += 1;
  line.Update(Event("c.jpg", 3, 0.3));
  line.Update(Event("", 10, 1));  // end of the stage
  std::istringstream lines(out_.str());
  std::string text;
  std::getline(lines, text);
  EXPECT_EQ(text, "[ 10%] photometric: image 1/10, a.jpg");
  std::getline(lines, text);
  EXPECT_THAT(text, HasSubstr("image 3/10"));
  std::getline(lines, text);
  EXPECT_EQ(text, "[100%] photometric: image 10/10");
  EXPECT_FALSE(std::getline(lines, text));
  EXPECT_THAT(out_.str(), Not(HasSubstr("\033")));
}

TEST_F(ProgressLineTest, WarningsAndErrorsGoToTheErrorStream) {
  ProgressLine line = Make(false);
  line.Log(LogLevel::kWarning, "careful");
  line.Log(LogLevel::kError, "bad");
  EXPECT_EQ(err_.str(), "WARNING: careful\nERROR: bad\n");
  EXPECT_EQ(out_.str(), "");
}

TEST_F(ProgressLineTest, ControlCharactersNeverReachTheTerminal) {
  ProgressLine line = Make(true);
  line.Log(LogLevel::kError, "two\nlines\033[2J");
  EXPECT_EQ(err_.str(), "ERROR: two lines [2J\n");
}

TEST_F(ProgressLineTest, OddFractionsStayWithinZeroAndHundred) {
  ProgressLine line = Make(false);
  for (const double fraction :
       {double{NAN}, -1.0, 7.0, double{INFINITY}, -double{INFINITY}}) {
    out_.str("");
    now_ += 60;
    line.Update(Event("a.jpg", 1, fraction));
    EXPECT_THAT(out_.str(),
                testing::AnyOf(HasSubstr("[  0%]"), HasSubstr("[100%]")));
  }
}

TEST_F(ProgressLineTest, GlobalLocaleChangesNothing) {
  const CommaLocale comma;
  ProgressLine line = Make(false);
  line.Update({"photometric", "a", 1234, 5678, 0.5, ""});
  EXPECT_THAT(out_.str(), HasSubstr("image 1234/5678"));
}

}  // namespace
}  // namespace hpm
