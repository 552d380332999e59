#include "colmap_plugin/inspect/report_table.h"

#include "colmap_plugin/controller/filter_criterion.h"
#include "colmap_plugin/inspect/bar_chart.h"
#include "colmap_plugin/inspect/html.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

// Of the pixels that neither have a depth nor were dropped.
constexpr char kOfNone[] = "#eee";

struct Criterion {
  FilterCriterion criterion;
  const char* color;
  const char* what;
};

constexpr Criterion kCriteria[] = {
    {FilterCriterion::kFacing,
     "#8c564b",
     "all sources look at the back of the surface found"},
    {FilterCriterion::kAngle,
     "#9467bd",
     "no source sees it under a large enough angle"},
    {FilterCriterion::kGeometry,
     "#d62728",
     "the sources found another depth there, or none"},
    {FilterCriterion::kCorrelation,
     "#ff7f0e",
     "the images look different there"},
    {FilterCriterion::kNumConsistent,
     "#e7ba52",
     "some sources confirm it, but too few"},
    {FilterCriterion::kUnexplained,
     "#7fb3d5",
     "a plain surface that nothing explains, as a sky"},
    {FilterCriterion::kRange,
     "#7f7f7f",
     "outside of the depth range given by hand"}};

std::string Percent(double share) { return fmt::format("{:.1f}", 100 * share); }

std::string Image(const std::string& jpeg, const char* what) {
  if (jpeg.empty()) return "";
  return fmt::format(
      "<img alt=\"{}\" loading=\"lazy\" src=\"data:image/jpeg;base64,{}\">",
      what,
      Base64(jpeg));
}

std::string Cell(const std::string& value, const std::string& shown) {
  return fmt::format("<td class=\"n\" data-v=\"{}\">{}</td>", value, shown);
}

// What became of the pixels, as a bar of coloured parts.
std::string LossBar(const ReportedImage& image) {
  constexpr double kWidth = 120;
  std::string parts;
  double x = 0;
  const auto add = [&](double share, const char* color, const std::string& of) {
    const double width = kWidth * std::clamp(share, 0.0, 1.0);
    parts += fmt::format(
        "<rect x=\"{:.1f}\" width=\"{:.1f}\" height=\"12\" "
        "fill=\"{}\"><title>{}: {} %</title></rect>",
        x,
        width,
        color,
        Html(of),
        Percent(share));
    x += width;
  };
  add(image.valid_share.value_or(0), "#2ca02c", "depth");
  for (const Criterion& c : kCriteria) {
    const auto loss = image.losses.find(NameOf(c.criterion));
    if (loss != image.losses.end()) add(loss->second, c.color, loss->first);
  }
  return fmt::format(
      "<svg width=\"{0}\" height=\"12\" role=\"img\"><rect "
      "width=\"{0}\" height=\"12\" fill=\"{1}\"/>{2}</svg>",
      kWidth,
      kOfNone,
      parts);
}

std::string MainLoss(const ReportedImage& image) {
  const auto most = std::max_element(
      image.losses.begin(),
      image.losses.end(),
      [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == image.losses.end() || most->second < 0.05) return "";
  return fmt::format(
      "most lost to: {}, {} %", most->first, Percent(most->second));
}

std::string Span(const std::optional<DepthSpan>& span) {
  return span ? fmt::format("{:.4g} ... {:.4g}", span->near, span->far)
              : "none";
}

std::string Sources(const ReportedImage& image) {
  std::string list;
  for (const ReportedSource& source : image.sources) {
    list += fmt::format(
        "{}: {} shared points<br>", Html(source.name), source.num_shared);
  }
  return fmt::format(
      "<details><summary>{}</summary>{}</details>", image.sources.size(), list);
}

std::string Costs(const ReportedImage& image) {
  if (!image.has_maps) return "";
  if (!image.costs) return "not known";
  const auto& bins = image.costs->bins;
  return Svg({3, 20, "#1f77b4", "0", "2", {}}, {bins.begin(), bins.end()}) +
         fmt::format("<span class=\"small\">median {:.2f}</span>",
                     image.costs->Median());
}

std::string Row(const ReportedImage& image, bool with_confidence) {
  uint64_t num_shared = 0;
  for (const ReportedSource& source : image.sources)
    num_shared += source.num_shared;
  const size_t num_sources = image.sources.size();
  const double shared = num_sources > 0 ? static_cast<double>(num_shared) /
                                              static_cast<double>(num_sources)
                                        : 0;
  std::string row = fmt::format(
      "<tr><td class=\"name\" data-v=\"{0}\">{0}<br><span "
      "class=\"small\">{1}x{2}</span></td>",
      Html(image.name),
      image.width,
      image.height);
  std::vector<std::pair<const std::string*, const char*>> pictures = {
      {&image.picture, "image"},
      {&image.depth, "depth"},
      {&image.normal, "normals"}};
  if (with_confidence) pictures.push_back({&image.confidence, "confidence"});
  for (const auto& [jpeg, what] : pictures) {
    row += fmt::format(
        "<td data-v=\"{}\">{}</td>", jpeg->empty() ? 0 : 1, Image(*jpeg, what));
  }
  const std::string why = !image.why_not.empty() ? Html(image.why_not)
                          : image.has_maps       ? ""
                                                 : "no maps";
  row += Cell(
      fmt::format("{:.4f}", image.valid_share.value_or(-1)),
      image.has_maps && image.valid_share
          ? Percent(*image.valid_share) + " %" +
                (why.empty() ? ""
                             : "<br><span class=\"small\">" + why + "</span>")
          : why);
  row += fmt::format(
      "<td data-v=\"{:.4f}\">{}<br><span class=\"small\">{}</span></td>",
      1 - image.valid_share.value_or(1),
      LossBar(image),
      Html(MainLoss(image)));
  row += Cell(
      fmt::format("{:.4f}",
                  image.has_maps && image.costs ? image.costs->Median() : -1),
      Costs(image));
  row += Cell(std::to_string(num_sources), Sources(image));
  row += Cell(fmt::format("{:.0f}", shared), fmt::format("{:.0f}", shared));
  row += fmt::format(
      "<td data-v=\"{}\">{}<br><span class=\"small\">points: {}{}</span></td>",
      image.depths ? image.depths->far : 0,
      Span(image.depths),
      Span(image.sparse_depths),
      image.HasOddRange() ? "<br>far from the points" : "");
  row += Cell(fmt::format("{:.3f}", image.seconds.value_or(-1)),
              image.seconds ? fmt::format("{:.1f} s", *image.seconds) : "");
  return row + "</tr>\n";
}

std::string Table(const ReportData& data) {
  std::string html =
      "<h2>Images</h2><p class=\"small\">A click on a heading sorts. The bar "
      "shows what became of the pixels: green has a depth, the other colours "
      "are explained below.</p>";
  if (data.images.size() > kMaxPictured) {
    html += fmt::format(
        "<p class=\"small\">Pictures are shown of {} of the {} images: those "
        "with the smallest share of pixels with a depth.</p>",
        kMaxPictured,
        data.images.size());
  }
  html += "<table id=\"images\"><thead><tr><th>image</th>";
  const bool with_confidence = std::any_of(
      data.images.begin(), data.images.end(), [](const ReportedImage& image) {
        return !image.confidence.empty();
      });
  std::vector<const char*> headings = {"picture", "depth", "normals"};
  if (with_confidence) headings.push_back("confidence");
  headings.insert(headings.end(),
                  {"with depth",
                   "pixels",
                   "costs",
                   "sources",
                   "shared points",
                   "depth range",
                   "time"});
  for (const char* heading : headings) {
    html += fmt::format("<th data-n>{}</th>", heading);
  }
  html += "</tr></thead><tbody>\n";
  for (const ReportedImage& image : data.images)
    html += Row(image, with_confidence);
  return html + "</tbody></table>\n";
}

std::string Legend() {
  std::string html =
      "<h2>Why pixels have no depth</h2><table><tr><th></th><th>dropped "
      "by</th><th>because</th><th>what helps</th></tr>";
  const auto row = [&](const char* color,
                       const char* name,
                       const char* what,
                       const char* remedy) {
    html += fmt::format(
        "<tr><td><svg width=\"12\" height=\"12\"><rect width=\"12\" "
        "height=\"12\" "
        "fill=\"{}\"/></svg></td><td>{}</td><td>{}</td><td>{}</td></tr>",
        color,
        name,
        Html(what),
        Html(remedy));
  };
  for (const Criterion& c : kCriteria)
    row(c.color, NameOf(c.criterion), c.what, RemedyFor(c.criterion));
  row(kOfNone, "none", "masked, or no depth was found to begin with", "");
  return html + "</table>\n";
}

}  // namespace

std::string ReportTable(const ReportData& data) {
  return Table(data) + Legend();
}

}  // namespace hpm
