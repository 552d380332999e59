#include "src/prior/weak_regions.h"

#include "src/base/large_vectors.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr double kBlur = 1.0;  // pixels
// Rows that what OpenCV finds at a pixel depends on, above and below: of the
// blur, whose window OpenCV makes four sigma wide, the gradient and the
// erosion.
constexpr int kBlurRows = 4, kGradientRows = 1, kErosionRows = 1;
constexpr int kRowsOfBand = 64;

// Pixels [begin, end) of a row, as long as they can be.
struct Run {
  int row, begin, end;
};

using Runs = std::vector<Run>;  // row by row, from left to right

// Of an image of `height` rows.
Rows Widened(const Rows& rows, int by, int height) {
  return {std::max(0, rows.begin - by), std::min(height, rows.end + by)};
}

int NumBands(int height) { return (height + kRowsOfBand - 1) / kRowsOfBand; }

Rows BandAt(int i, int height) {
  return {i * kRowsOfBand, std::min(height, (i + 1) * kRowsOfBand)};
}

cv::Mat Square3() { return cv::getStructuringElement(cv::MORPH_RECT, {3, 3}); }

// Of the blurred image, grey levels per pixel.
cv::Mat GradientOf(const cv::Mat& gray) {
  cv::Mat blurred, dx, dy;
  gray.convertTo(blurred, CV_32F);
  cv::GaussianBlur(blurred, blurred, cv::Size(), kBlur);
  cv::Sobel(blurred, dx, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(blurred, dy, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::magnitude(dx, dy, dx);
  return dx;
}

// The weak pixels of these rows, eroded, so that gaps one pixel wide in an edge
// do not join what lies on its sides. The rows are cut out with what they
// depend on, so that the bands give what the whole image would.
Runs WeakRuns(const GrayImage& image, const Rows& rows, float max_gradient) {
  const Rows weak_rows = Widened(rows, kErosionRows, image.height);
  const Rows grey_rows =
      Widened(weak_rows, kBlurRows + kGradientRows, image.height);
  const cv::Mat grey(
      grey_rows.end - grey_rows.begin,
      image.width,
      CV_8U,
      const_cast<uint8_t*>(
          &image.data[static_cast<size_t>(grey_rows.begin) * image.width]));
  cv::Mat weak =
      GradientOf(grey).rowRange(weak_rows.begin - grey_rows.begin,
                                weak_rows.end - grey_rows.begin) < max_gradient;
  cv::erode(weak, weak, Square3());
  Runs runs;
  for (int row = rows.begin; row < rows.end; ++row) {
    const uint8_t* pixels = weak.ptr<uint8_t>(row - weak_rows.begin);
    const uint8_t* end = pixels + image.width;
    for (const uint8_t* at = pixels;;) {
      at = std::find_if(at, end, [](uint8_t w) { return w != 0; });
      if (at == end) break;
      const uint8_t* behind = std::find(at, end, uint8_t{0});
      runs.push_back({row,
                      static_cast<int>(at - pixels),
                      static_cast<int>(behind - pixels)});
      at = behind;
    }
  }
  return runs;
}

// Disjoint sets of runs; the first run of a set stands for it.
class Sets {
 public:
  explicit Sets(size_t size) : parents_(size) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  int Find(int i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }

  void Join(int i, int j) {
    i = Find(i);
    j = Find(j);
    parents_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<int> parents_;
};

// 4-connected: where runs of neighbouring rows share a column.
void JoinNeighbours(const Runs& runs, Sets* sets) {
  size_t above = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    const Run& run = runs[i];
    while (runs[above].row + 1 < run.row ||
           (runs[above].row + 1 == run.row && runs[above].end <= run.begin)) {
      ++above;
    }
    // The last one may reach over the next run, too.
    for (size_t k = above;
         runs[k].row + 1 == run.row && runs[k].begin < run.end;
         ++k) {
      sets->Join(static_cast<int>(k), static_cast<int>(i));
    }
  }
}

// The number of each run's region, in the order in which an image is read; 0
// for those of regions below `min_area`.
std::vector<uint16_t> NameRuns(const Runs& runs,
                               double min_area,
                               int* num_regions) {
  Sets sets(runs.size());
  JoinNeighbours(runs, &sets);
  std::vector<int> areas(runs.size(), 0);
  for (size_t i = 0; i < runs.size(); ++i)
    areas[sets.Find(static_cast<int>(i))] += runs[i].end - runs[i].begin;
  std::vector<uint16_t> names(runs.size(), 0);
  for (size_t i = 0; i < runs.size(); ++i) {
    const auto first = static_cast<size_t>(sets.Find(static_cast<int>(i)));
    if (first != i) {
      names[i] = names[first];
    } else if (areas[i] >= min_area) {
      names[i] = static_cast<uint16_t>(++*num_regions);
    }
  }
  return names;
}

// Writes the labels of these rows: the runs' names, grown by a pixel to where
// nothing else is.
void Draw(const Runs& runs,
          const std::vector<uint16_t>& names,
          const Rows& rows,
          WeakRegions* regions) {
  const Rows read = Widened(rows, 1, regions->height);
  cv::Mat kept = cv::Mat::zeros(read.end - read.begin, regions->width, CV_16U);
  auto run = std::lower_bound(
      runs.begin(), runs.end(), read.begin, [](const Run& r, int row) {
        return r.row < row;
      });
  for (; run != runs.end() && run->row < read.end; ++run) {
    uint16_t* pixels = kept.ptr<uint16_t>(run->row - read.begin);
    std::fill(pixels + run->begin,
              pixels + run->end,
              names[static_cast<size_t>(run - runs.begin())]);
  }
  cv::Mat grown;
  cv::dilate(kept, grown, Square3());
  for (int row = rows.begin; row < rows.end; ++row) {
    const uint16_t* own = kept.ptr<uint16_t>(row - read.begin);
    const uint16_t* near = grown.ptr<uint16_t>(row - read.begin);
    uint16_t* label =
        &regions->label[static_cast<size_t>(row) * regions->width];
    for (int col = 0; col < regions->width; ++col)
      label[col] = own[col] > 0 ? own[col] : near[col];
  }
}

}  // namespace

void WeakRegions::ForEachBand(
    const std::function<void(const Rows&)>& visit) const {
  tbb::parallel_for(
      0, NumBands(height), [&](int i) { visit(BandAt(i, height)); });
}

LabelWindows::LabelWindows(const WeakRegions& regions,
                           const Rows& rows,
                           int radius)
    : width_(regions.width) {
  const Rows read = Widened(rows, radius, regions.height);
  first_row_ = read.begin;
  const int num_rows = read.end - read.begin;
  least_.resize(static_cast<size_t>(num_rows) * width_);
  greatest_.resize(least_.size());
  const cv::Mat labels(
      num_rows,
      width_,
      CV_16U,
      const_cast<uint16_t*>(
          &regions.label[static_cast<size_t>(read.begin) * width_]));
  cv::Mat least(num_rows, width_, CV_16U, least_.data());
  cv::Mat greatest(num_rows, width_, CV_16U, greatest_.data());
  const int side = 2 * radius + 1;
  const cv::Mat window =
      cv::getStructuringElement(cv::MORPH_RECT, {side, side});
  cv::erode(labels, least, window);
  cv::dilate(labels, greatest, window);
}

WeakRegions FindWeakRegions(const GrayImage& image,
                            float max_gradient,
                            float min_share) {
  WeakRegions regions;
  regions.width = image.width;
  regions.height = image.height;
  const int num_bands = NumBands(image.height);
  std::vector<Runs> of_band(num_bands);
  tbb::parallel_for(0, num_bands, [&](int i) {
    of_band[i] = WeakRuns(image, BandAt(i, image.height), max_gradient);
  });
  Runs runs;
  for (Runs& band : of_band) {
    runs.insert(runs.end(), band.begin(), band.end());
    Runs().swap(band);
  }
  const double min_area = min_share * image.width * image.height;
  const std::vector<uint16_t> names =
      NameRuns(runs, min_area, &regions.num_regions);
  regions.label = Filled(image.data.size(), uint16_t{0});
  tbb::parallel_for(0, num_bands, [&](int i) {
    Draw(runs, names, BandAt(i, image.height), &regions);
  });
  return regions;
}

}  // namespace hpm
