#include "colmap_plugin/inspect/report_data.h"
#include "colmap_plugin/inspect/report_html.h"
#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string SmallPng() {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", cv::Mat(12, 16, CV_8U, cv::Scalar(9)), bytes);
  return {bytes.begin(), bytes.end()};
}

class ReportTest : public testing::Test {
 protected:
  // Each of which is a reference, with the next as its source.
  void AddImages(int count) {
    std::string cfg;
    for (int i = 0; i < count; ++i) {
      files_.AddImage(NameOf(i), {0.1 * i, 0, 0});
      WriteFile(files_.path() / "images" / NameOf(i), SmallPng());
      cfg += NameOf(i) + "\n" + NameOf((i + 1) % count) + "\n";
    }
    files_.WriteCfg(cfg);
  }

  ReportData Gather() {
    files_.Open();
    ControllerOptions options;
    options.workspace.path = files_.path();
    options.problems.depth_min = 1;
    options.problems.depth_max = 10;
    return GatherReport(options, files_.Log(), CancelToken());
  }

  // Of 2x1 pixels.
  void WriteMapOf(int image,
                  const char* folder,
                  int num_channels,
                  const std::vector<float>& values) {
    std::string bytes = fmt::format("2&1&{}&", num_channels);
    bytes.append(reinterpret_cast<const char*>(values.data()),
                 values.size() * sizeof(float));
    WriteFile(
        files_.path() / "stereo" / folder / (NameOf(image) + ".geometric.bin"),
        bytes);
  }

  static std::string NameOf(int i) { return fmt::format("{:03}.png", i); }

  TestWorkspace files_;
};

TEST_F(ReportTest, CountsSharedPointsAndSpansTheirDepths) {
  AddImages(3);
  files_.AddPoint({0, 0, 2}, {0, 1});
  files_.AddPoint({0, 0, 4}, {0, 1, 2});
  const ReportData data = Gather();
  ASSERT_EQ(data.images.size(), 3u);
  ASSERT_EQ(data.images[0].sources.size(), 1u);
  EXPECT_EQ(data.images[0].sources[0].name, NameOf(1));
  EXPECT_EQ(data.images[0].sources[0].num_shared, 2u);
  EXPECT_EQ(data.images[1].sources[0].num_shared, 1u);
  ASSERT_TRUE(data.images[0].sparse_depths);
  EXPECT_EQ(data.images[0].sparse_depths->near, 2);
  EXPECT_EQ(data.images[2].sparse_depths->near, 4);
  EXPECT_FALSE(data.images[0].picture.empty());
}

TEST_F(ReportTest, LeavesOutPicturesThatNoRunWouldUse) {
  AddImages(3);
  // Of other proportions than its camera.
  std::vector<unsigned char> tall;
  cv::imencode(".png", cv::Mat(16, 12, CV_8U, cv::Scalar(9)), tall);
  WriteFile(files_.path() / "images" / NameOf(1),
            {reinterpret_cast<char*>(tall.data()), tall.size()});
  const ReportData data = Gather();
  EXPECT_FALSE(data.images[0].picture.empty());
  EXPECT_TRUE(data.images[1].picture.empty());
}

TEST_F(ReportTest, ShowsPicturesOfTheWorstImagesOnly) {
  const int count = static_cast<int>(kMaxPictured) + 2;
  AddImages(count);
  for (int i = 0; i < count; ++i) {
    // Half of the pixels, but for the last.
    WriteMapOf(i, "depth_maps", 1, {0, i == count - 1 ? 0.f : 3.f});
    WriteMapOf(i, "normal_maps", 3, {0, 0, 0, 0, 0, -1});
  }
  const ReportData data = Gather();
  std::vector<int> hidden;
  for (int i = 0; i < count; ++i) {
    const ReportedImage& image = data.images[i];
    EXPECT_TRUE(image.has_maps);
    EXPECT_EQ(image.picture.empty(), image.depth.empty());
    EXPECT_EQ(image.picture.empty(), image.normal.empty());
    if (image.picture.empty()) hidden.push_back(i);
  }
  EXPECT_THAT(hidden, ElementsAre(count - 3, count - 2));
  EXPECT_THAT(ReportHtml(data),
              HasSubstr(fmt::format("{} of the {} images", count - 2, count)));
}

TEST_F(ReportTest, TakesARunRecordOfWhateverTypes) {
  AddImages(2);
  const char* const values[] = {
      "null",
      "1",
      "-1.5",
      "true",
      "\"text\"",
      "[]",
      "[[1]]",
      "{}",
      R"({"000.png": 3})",
      R"({"000.png": {"geometric": [1]}})",
      R"({"000.png": {"geometric": {"seconds": {"match": "long"}}}})"};
  for (const char* value : values) {
    std::string record = "{";
    for (const char* key : {"images",
                            "seconds_per_phase",
                            "backend",
                            "images_computed",
                            "images_kept",
                            "seconds",
                            "peak_memory_bytes",
                            "warnings",
                            "images_failed",
                            "options"}) {
      if (record.size() > 1) record += ", ";
      record += fmt::format("\"{}\": {}", key, value);
    }
    WriteFile(files_.path() / "stereo/hpm_mvs/run.json", record + "}");
    EXPECT_THAT(ReportHtml(Gather()), HasSubstr("</html>")) << value;
  }
  for (const char* text : {"", "[]", "3", "{\"images\"", "\xff"}) {
    WriteFile(files_.path() / "stereo/hpm_mvs/run.json", text);
    EXPECT_THAT(ReportHtml(Gather()), Not(HasSubstr("peak memory"))) << text;
  }
}

// Names as people sort them, all else as numbers, of which every cell has one.
TEST(ReportHtmlTest, ColumnsSortAsWhatTheyHold) {
  ReportData data;
  data.images.resize(2);
  data.images[0].name = "9.jpg";
  data.images[1].name = "10.jpg";
  data.images[1].depths = DepthSpan{1, 1e9f};
  const std::string page = ReportHtml(data);
  EXPECT_THAT(page, HasSubstr("<th>image</th><th data-n>picture</th>"));
  EXPECT_THAT(page, HasSubstr("localeCompare"));
  size_t num_cells = 0;
  for (size_t at = page.find("data-v=\""); at != std::string::npos;
       at = page.find("data-v=\"", at + 1)) {
    const size_t begin = at + 8;
    const std::string value = page.substr(begin, page.find('"', begin) - begin);
    if (++num_cells % 11 == 1) continue;  // the name
    size_t length = 0;
    EXPECT_NO_THROW(std::stod(value, &length)) << value;
    EXPECT_EQ(length, value.size()) << value;
  }
  EXPECT_EQ(num_cells, 22u);
}

TEST(ReportHtmlTest, ShowsTheCostsOfEachImageAndOfAll) {
  ReportData data;
  data.images.resize(2);
  for (ReportedImage& image : data.images) {
    image.has_maps = true;
    image.costs.emplace();
  }
  data.images[0].costs->bins[1] = 30;
  data.images[1].costs->bins[5] = 10;
  const std::string page = ReportHtml(data);
  EXPECT_THAT(page, HasSubstr("0.1 to 0.2: 75.0 %"));
  EXPECT_THAT(page, HasSubstr("0.5 to 0.6: 25.0 %"));
  EXPECT_THAT(page, HasSubstr("median 0.15"));
  EXPECT_THAT(page, HasSubstr("median 0.55"));
  EXPECT_THAT(page, Not(HasSubstr("not known")));
  EXPECT_THAT(page, Not(HasSubstr("Not known")));
}

TEST(ReportHtmlTest, SaysOfWhichMapsNoCostsAreKnown) {
  ReportData data;
  data.images.resize(3);
  for (ReportedImage& image : data.images) image.has_maps = true;
  data.images[1].costs.emplace().bins[0] = 1;
  const std::string page = ReportHtml(data);
  EXPECT_THAT(page, HasSubstr("Not known of 2 of 3 images"));
  EXPECT_THAT(page, HasSubstr("not known"));
  data.images.clear();
  EXPECT_THAT(ReportHtml(data), Not(HasSubstr("Matching costs")));
}

TEST(ReportHtmlTest, ExplainsEveryColour) {
  ReportData data;
  data.images.resize(1);
  data.images[0].losses = {{"geometry", 0.2}};
  const std::string page = ReportHtml(data);
  const size_t legend = page.find("Why pixels have no depth");
  ASSERT_NE(legend, std::string::npos);
  for (const char* word : {"#d62728",
                           "#eee",
                           "masked, or no depth was found",
                           "filter_geom_consistency_max_cost"}) {
    EXPECT_NE(page.find(word, legend), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace hpm
