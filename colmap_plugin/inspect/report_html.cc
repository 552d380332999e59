#include "colmap_plugin/inspect/report_html.h"

#include "colmap_plugin/inspect/bar_chart.h"
#include "colmap_plugin/inspect/html.h"
#include "colmap_plugin/inspect/report_table.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr int kNumBins = 20;
constexpr int kBarWidth = 24, kBarHeight = 80;

// Styles and the one script, which sorts the table; nothing is fetched from
// anywhere, and the page says so to the browser.
constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width">
<title>Dense stereo report</title>
<style>
body{font:14px/1.4 system-ui,sans-serif;margin:1em;color:#222;background:#fff}
h1{font-size:1.4em}h2{font-size:1.1em;margin-top:1.6em}
table{border-collapse:collapse}td,th{padding:.3em .4em;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}
#images th{cursor:pointer;position:sticky;top:0;background:#f4f4f4}
td.n{text-align:right;font-variant-numeric:tabular-nums}img{display:block}
.name{overflow-wrap:anywhere;min-width:6em;max-width:16em}.warn li{margin:.3em 0}.small{color:#666;font-size:.9em}
svg text{font:11px system-ui,sans-serif}
</style></head><body>
)";

constexpr char kScript[] = R"(<script>
document.querySelectorAll('#images th').forEach(function(th, column) {
  var down = false, isNumeric = th.hasAttribute('data-n');
  th.addEventListener('click', function() {
    var body = document.querySelector('#images tbody');
    var rows = Array.from(body.rows);
    var key = function(row) {
      return row.cells[column].getAttribute('data-v');
    };
    rows.sort(function(a, b) {
      var x = key(a), y = key(b);
      return (isNumeric ? Number(x) - Number(y) : x.localeCompare(y)) *
             (down ? -1 : 1);
    });
    down = !down;
    rows.forEach(function(row) { body.appendChild(row); });
  });
});
</script>
)";

// How many images have which share of pixels with a depth.
std::string ValidShares(const ReportData& data) {
  std::vector<double> bins(kNumBins, 0);
  for (const ReportedImage& image : data.images) {
    if (!image.has_maps || !image.valid_share) continue;
    ++bins[static_cast<size_t>(std::clamp(
        static_cast<int>(*image.valid_share * kNumBins), 0, kNumBins - 1))];
  }
  BarChart chart = {kBarWidth, kBarHeight, "#2ca02c", "0 %", "100 %", {}};
  for (int i = 0; i < kNumBins; ++i) {
    chart.titles.push_back(fmt::format("{} to {} %: {:.0f} images",
                                       100 * i / kNumBins,
                                       100 * (i + 1) / kNumBins,
                                       bins[static_cast<size_t>(i)]));
  }
  return "<h2>Pixels with a depth, by image</h2>" + Svg(chart, bins) + "\n";
}

// Which share of the pixels with a depth has which cost, over all images.
std::string Costs(const ReportData& data) {
  CostHistogram costs;
  int num_known = 0, num_maps = 0;
  for (const ReportedImage& image : data.images) {
    num_maps += image.has_maps;
    if (!image.has_maps || !image.costs) continue;
    ++num_known;
    costs += *image.costs;
  }
  if (num_maps == 0) return "";
  std::string html = "<h2>Matching costs of the pixels with a depth</h2>";
  if (num_known < num_maps) {
    html += fmt::format(
        "<p class=\"small\">Not known of {} of {} images: their maps were made "
        "by an older version or another program.</p>",
        num_maps - num_known,
        num_maps);
  }
  const auto count = static_cast<double>(costs.Count());
  if (count == 0) return html + "\n";
  BarChart chart = {kBarWidth, kBarHeight, "#1f77b4", "0: alike", "2", {}};
  for (int i = 0; i < kNumCostBins; ++i) {
    chart.titles.push_back(fmt::format(
        "{:.1f} to {:.1f}: {:.1f} %",
        kMaxCost * static_cast<float>(i) / kNumCostBins,
        kMaxCost * static_cast<float>(i + 1) / kNumCostBins,
        100 * static_cast<double>(costs.bins[static_cast<size_t>(i)]) / count));
  }
  return html +
         "<p class=\"small\">0 where the images look alike, 1 where they have "
         "nothing in common; after geometric passes with what their depths "
         "disagree. Of each pixel as the last pass left it.</p>" +
         Svg(chart, {costs.bins.begin(), costs.bins.end()}) +
         fmt::format("<p>median {:.2f}</p>\n", costs.Median());
}

double Number(const nlohmann::json& value) {
  return value.is_number() ? value.get<double>() : 0;
}

std::string Value(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string Phases(const nlohmann::json& run) {
  const nlohmann::json& phases = Member(run, "seconds_per_phase");
  double most = 0;
  for (const auto& [phase, seconds] : phases.items()) {
    if (seconds.is_number()) most = std::max(most, seconds.get<double>());
  }
  if (!(most > 0)) return "";
  std::string html = "<h2>Time per phase, all images</h2><table>";
  for (const auto& [phase, seconds] : phases.items()) {
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
    row("pixels with a depth", fmt::format("{:.1f} %", 100 * share / num_maps));
  const nlohmann::json& run = data.run;
  if (run.is_object()) {
    for (const auto& [key, what] :
         {std::pair("backend", "computed on"),
          std::pair("images_computed", "images computed by the last run"),
          std::pair("images_kept", "images kept by it")}) {
      if (run.contains(key)) row(what, Value(run[key]));
    }
    row("time of the last run",
        fmt::format("{:.1f} min", Number(Member(run, "seconds")) / 60));
    row("peak memory",
        fmt::format("{:.2f} GiB",
                    Number(Member(run, "peak_memory_bytes")) / (1 << 30)));
  }
  return "<table>" + rows + "</table>\n";
}

std::string Warnings(const ReportData& data) {
  std::vector<std::string> lines;
  for (const nlohmann::json& line : Member(data.run, "warnings"))
    lines.push_back(Value(line));
  const nlohmann::json& failed = Member(data.run, "images_failed");
  if (!failed.empty()) {
    lines.push_back(
        fmt::format("{} images could not be computed, the first: {}",
                    failed.size(),
                    Value(failed.front())));
  }
  int num_odd = 0, num_few = 0;
  std::string odd, few;
  for (const ReportedImage& image : data.images) {
    if (image.HasOddRange() && num_odd++ == 0) odd = image.name;
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
  const nlohmann::json& options = Member(run, "options");
  if (options.empty()) return "";
  std::string rows;
  for (const auto& [name, value] : options.items()) {
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
         Warnings(data) + ValidShares(data) + Costs(data) + ReportTable(data) +
         Phases(data.run) + Options(data.run) + kScript + "</body></html>\n";
}

}  // namespace hpm
