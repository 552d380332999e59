#include "colmap_plugin/inspect/report_html.h"

#include "colmap_plugin/controller/filter_criterion.h"
#include "colmap_plugin/inspect/html.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr int kNumBins = 20;

// Styles and the one script, which sorts the table; nothing is fetched from
// anywhere, and the page says so to the browser.
constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width">
<title>Dense stereo report</title>
<style>
body{font:14px/1.4 system-ui,sans-serif;margin:1.5em;color:#222;background:#fff}
h1{font-size:1.4em}h2{font-size:1.1em;margin-top:1.6em}
table{border-collapse:collapse}td,th{padding:.3em .6em;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}
#images th{cursor:pointer;position:sticky;top:0;background:#f4f4f4;white-space:nowrap}
td.n{text-align:right;font-variant-numeric:tabular-nums}img{display:block}
.name{word-break:break-all;max-width:16em}.warn li{margin:.3em 0}.small{color:#666;font-size:.9em}
svg text{font:11px system-ui,sans-serif}
</style></head><body>
)";

constexpr char kScript[] = R"(<script>
document.querySelectorAll('#images th').forEach(function(th, column) {
  var down = false;
  th.addEventListener('click', function() {
    var body = document.querySelector('#images tbody');
    var rows = Array.from(body.rows);
    var key = function(row) {
      var v = row.cells[column].getAttribute('data-v');
      var n = parseFloat(v);
      return isNaN(n) ? v : n;
    };
    rows.sort(function(a, b) {
      var x = key(a), y = key(b);
      return (x < y ? -1 : x > y ? 1 : 0) * (down ? -1 : 1);
    });
    down = !down;
    rows.forEach(function(row) { body.appendChild(row); });
  });
});
</script>
)";

struct Criterion {
  FilterCriterion criterion;
  const char* color;
  const char* what;
  const char* remedy;
};

constexpr Criterion kCriteria[] = {
    {FilterCriterion::kFacing,
     "#8c564b",
     "all sources look at the back of the surface found",
     "more images of this side; a depth that cannot be is dropped rightly"},
    {FilterCriterion::kAngle,
     "#9467bd",
     "no source sees it under a large enough angle",
     "images taken further apart, or a lower "
     "--PatchMatchStereo.filter_min_triangulation_angle"},
    {FilterCriterion::kGeometry,
     "#d62728",
     "the sources found another depth there, or none",
     "things that move, reflect or are seen by one image only; else check "
     "poses and overlap, or raise "
     "--PatchMatchStereo.filter_geom_consistency_max_cost"},
    {FilterCriterion::kCorrelation,
     "#ff7f0e",
     "the images look different there",
     "mirrors, glass, shadows that moved, masked parts of sources; or a lower "
     "--PatchMatchStereo.filter_min_ncc"},
    {FilterCriterion::kNumConsistent,
     "#e7ba52",
     "some sources confirm it, but too few",
     "more images, or a lower --PatchMatchStereo.filter_min_num_consistent"},
    {FilterCriterion::kUnexplained,
     "#7fb3d5",
     "a plain surface that nothing explains, as a sky",
     "--Hpm.filter_min_agreement 0 keeps more of it; a mask leaves it out"},
    {FilterCriterion::kRange,
     "#7f7f7f",
     "outside of the depth range given by hand",
     "change --PatchMatchStereo.depth_min and depth_max"}};

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
  constexpr double kWidth = 160;
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
      "width=\"{0}\" height=\"12\" fill=\"#eee\"/>{1}</svg>",
      kWidth,
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

// Far beyond what the sparse points let expect: worth a look.
bool IsOddRange(const ReportedImage& image) {
  return image.depths && image.sparse_depths &&
         (image.depths->far > 3 * image.sparse_depths->far ||
          image.depths->near < image.sparse_depths->near / 3);
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

std::string Row(const ReportedImage& image) {
  int num_shared = 0;
  for (const ReportedSource& source : image.sources)
    num_shared += source.num_shared;
  const size_t num_sources = image.sources.size();
  const double shared =
      num_sources > 0 ? static_cast<double>(num_shared) / num_sources : 0;
  std::string row = fmt::format(
      "<tr><td class=\"name\" data-v=\"{0}\">{0}<br><span "
      "class=\"small\">{1}x{2}</span></td>",
      Html(image.name),
      image.width,
      image.height);
  for (const auto& [jpeg, what] : {std::pair(&image.picture, "image"),
                                   std::pair(&image.depth, "depth"),
                                   std::pair(&image.normal, "normals")}) {
    row += fmt::format(
        "<td data-v=\"{}\">{}</td>", jpeg->empty() ? 0 : 1, Image(*jpeg, what));
  }
  const std::string why = !image.why_not.empty() ? Html(image.why_not)
                          : image.has_maps       ? ""
                                                 : "no maps";
  row += Cell(fmt::format("{:.4f}", image.valid_share.value_or(-1)),
              image.has_maps && image.valid_share
                  ? Percent(*image.valid_share) + " %"
                  : why);
  row += fmt::format(
      "<td data-v=\"{:.4f}\">{}<br><span class=\"small\">{}</span></td>",
      1 - image.valid_share.value_or(1),
      LossBar(image),
      Html(MainLoss(image)));
  row += Cell(std::to_string(num_sources), Sources(image));
  row += Cell(fmt::format("{:.0f}", shared), fmt::format("{:.0f}", shared));
  row += fmt::format(
      "<td data-v=\"{}\">{}<br><span class=\"small\">points: {}{}</span></td>",
      image.depths ? image.depths->far : 0,
      Span(image.depths),
      Span(image.sparse_depths),
      IsOddRange(image) ? "<br>far from the points" : "");
  row += Cell(fmt::format("{:.3f}", image.seconds.value_or(-1)),
              image.seconds ? fmt::format("{:.1f} s", *image.seconds) : "");
  return row + "</tr>\n";
}

std::string Table(const ReportData& data) {
  std::string html =
      "<h2>Images</h2><p class=\"small\">A click on a heading sorts. The bar "
      "shows what became of the pixels: green has a depth, the other colours "
      "are explained below.</p><table id=\"images\"><thead><tr>";
  for (const char* heading : {"image",
                              "picture",
                              "depth",
                              "normals",
                              "with depth",
                              "pixels",
                              "sources",
                              "shared points",
                              "depth range",
                              "time"}) {
    html += fmt::format("<th>{}</th>", heading);
  }
  html += "</tr></thead><tbody>\n";
  for (const ReportedImage& image : data.images) html += Row(image);
  return html + "</tbody></table>\n";
}

std::string Legend() {
  std::string html =
      "<h2>Why pixels have no depth</h2><table><tr><th></th><th>dropped "
      "by</th><th>because</th><th>what helps</th></tr>";
  for (const Criterion& c : kCriteria) {
    html += fmt::format(
        "<tr><td><svg width=\"12\" height=\"12\"><rect width=\"12\" "
        "height=\"12\" "
        "fill=\"{}\"/></svg></td><td>{}</td><td>{}</td><td>{}</td></tr>",
        c.color,
        NameOf(c.criterion),
        Html(c.what),
        Html(c.remedy));
  }
  return html + "</table>\n";
}

// How many images have which share of pixels with a depth.
std::string Histogram(const ReportData& data) {
  int bins[kNumBins] = {};
  for (const ReportedImage& image : data.images) {
    if (!image.has_maps || !image.valid_share) continue;
    ++bins[std::clamp(
        static_cast<int>(*image.valid_share * kNumBins), 0, kNumBins - 1)];
  }
  const int most = std::max(1, *std::max_element(bins, bins + kNumBins));
  constexpr int kBar = 24, kHeight = 80;
  std::string bars;
  for (int i = 0; i < kNumBins; ++i) {
    const double height = static_cast<double>(kHeight) * bins[i] / most;
    bars += fmt::format(
        "<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" "
        "fill=\"#2ca02c\"><title>{} to {} %: {} images</title></rect>",
        i * kBar,
        kHeight - height,
        kBar - 2,
        height,
        100 * i / kNumBins,
        100 * (i + 1) / kNumBins,
        bins[i]);
  }
  return fmt::format(
      "<h2>Pixels with a depth, by image</h2><svg width=\"{}\" height=\"{}\" "
      "role=\"img\">{}<text x=\"0\" y=\"{}\">0 %</text><text x=\"{}\" "
      "y=\"{}\" text-anchor=\"end\">100 %</text></svg>\n",
      kNumBins * kBar,
      kHeight + 16,
      bars,
      kHeight + 14,
      kNumBins * kBar,
      kHeight + 14);
}

std::string Value(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string Phases(const nlohmann::json& run) {
  if (!run.is_object() || !run.contains("seconds_per_phase")) return "";
  double most = 0;
  for (const auto& [phase, seconds] : run["seconds_per_phase"].items()) {
    if (seconds.is_number()) most = std::max(most, seconds.get<double>());
  }
  if (!(most > 0)) return "";
  std::string html = "<h2>Time per phase, all images</h2><table>";
  for (const auto& [phase, seconds] : run["seconds_per_phase"].items()) {
    if (!seconds.is_number()) continue;
    const double time = seconds.get<double>();
    html += fmt::format(
        "<tr><td>{}</td><td class=\"n\">{:.1f} s</td><td><svg width=\"240\" "
        "height=\"12\"><rect width=\"{:.1f}\" height=\"12\" "
        "fill=\"#1f77b4\"/></svg></td></tr>",
        Html(phase),
        time,
        240 * time / most);
  }
  return html + "</table>\n";
}

std::string Summary(const ReportData& data) {
  int num_maps = 0;
  double share = 0;
  for (const ReportedImage& image : data.images) {
    num_maps += image.has_maps;
    if (image.has_maps) share += image.valid_share.value_or(0);
  }
  std::string rows;
  const auto row = [&](const std::string& what, const std::string& value) {
    rows +=
        fmt::format("<tr><td>{}</td><td>{}</td></tr>", Html(what), Html(value));
  };
  row("program", data.program);
  row("workspace", data.workspace);
  row("maps",
      fmt::format(
          "{} of {} images, {}", num_maps, data.images.size(), data.stage));
  if (num_maps > 0)
    row("pixels with a depth", Percent(share / num_maps) + " %");
  const nlohmann::json& run = data.run;
  if (run.is_object()) {
    for (const auto& [key, what] :
         {std::pair("backend", "computed on"),
          std::pair("images_computed", "images computed by the last run"),
          std::pair("images_kept", "images kept by it")}) {
      if (run.contains(key)) row(what, Value(run[key]));
    }
    const double seconds = run.value("seconds", 0.0);
    row("time of the last run", fmt::format("{:.1f} min", seconds / 60));
    const auto memory = run.value("peak_memory_bytes", uint64_t{0});
    row("peak memory",
        fmt::format("{:.2f} GiB", static_cast<double>(memory) / (1 << 30)));
  }
  return "<table>" + rows + "</table>\n";
}

std::string Warnings(const ReportData& data) {
  std::vector<std::string> lines;
  if (data.run.is_object()) {
    for (const auto& line : data.run.value("warnings", nlohmann::json::array()))
      lines.push_back(Value(line));
    const auto failed =
        data.run.value("images_failed", nlohmann::json::array());
    if (!failed.empty()) {
      lines.push_back(
          fmt::format("{} images could not be computed, the first: {}",
                      failed.size(),
                      Value(failed.front())));
    }
  }
  int num_odd = 0, num_few = 0;
  std::string odd, few;
  for (const ReportedImage& image : data.images) {
    if (IsOddRange(image) && num_odd++ == 0) odd = image.name;
    if (image.sources.size() < 3 && num_few++ == 0) few = image.name;
  }
  if (num_few > 0) {
    lines.push_back(fmt::format(
        "{} images have fewer than three sources (the first: {}): more images "
        "around them would help, or more sources in patch-match.cfg",
        num_few,
        few));
  }
  if (num_odd > 0) {
    lines.push_back(fmt::format(
        "the depths of {} images reach far beyond their sparse points (the "
        "first: {}): look at their maps; --PatchMatchStereo.depth_min and "
        "depth_max keep out what cannot be",
        num_odd,
        odd));
  }
  if (lines.empty()) return "<h2>Warnings</h2><p>None.</p>\n";
  std::string html = "<h2>Warnings</h2><ul class=\"warn\">";
  for (const std::string& line : lines) html += "<li>" + Html(line) + "</li>";
  return html + "</ul>\n";
}

std::string Options(const nlohmann::json& run) {
  if (!run.is_object() || !run.contains("options")) return "";
  std::string rows;
  for (const auto& [name, value] : run["options"].items()) {
    rows += fmt::format(
        "<tr><td>{}</td><td>{}</td></tr>", Html(name), Html(Value(value)));
  }
  return "<h2>Options of the last run</h2><details><summary>show</summary>"
         "<table>" +
         rows + "</table></details>\n";
}

}  // namespace

std::string ReportHtml(const ReportData& data) {
  return std::string(kHead) + "<h1>Dense stereo report</h1>\n" + Summary(data) +
         Warnings(data) + Histogram(data) + Table(data) + Legend() +
         Phases(data.run) + Options(data.run) + kScript + "</body></html>\n";
}

}  // namespace hpm
