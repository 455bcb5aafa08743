// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "cli/program/session.h"
#include "cli/simulation/comparison_report.h"
#include "sim/image_comparison/compared_sources.h"
#include "sim/image_comparison/comparison_figures.h"

namespace vernier::cli {
namespace {

constexpr const char* page_head = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>What images show of the sources</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 1240px; padding: 12px; color: #1d2733; }
h1 { font-size: 1.35rem; } h2 { font-size: 1.1rem; margin: 1.6em 0 .4em; }
p { max-width: 46rem; }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 460px), 1fr)); gap: 14px; }
figure { margin: 0; border: 1px solid #d5dbe3; border-radius: 6px; padding: 8px; }
figcaption { font-size: .85rem; margin-bottom: 4px; }
svg { width: 100%; height: auto; display: block; }
svg > * { paint-order: stroke; } svg > :is(text) { stroke: #fff; stroke-width: 3px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .82rem; }
th, td { padding: 3px 8px; text-align: right; border-bottom: 1px solid #e3e8ee; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
td.note { text-align: left; white-space: normal; min-width: 14rem; }
</style></head><body>
)";

/// A quantity of groups of edges, and what the simulator assumes of it.
struct Quantity {
  std::string title;
  std::function<double(const EdgeFigures&)> of;
  double assumed = std::numeric_limits<double>::quiet_NaN();
};

double wrong_share(const EdgeFigures& f) {
  constexpr int fewest = 10;
  const MatchFigures& m = f.matchers.front();
  return m.matched < fewest ? std::numeric_limits<double>::quiet_NaN()
                            : 100.0 * m.wrong / m.matched;
}

double assumed(const ComparisonReport& report, const std::string& key) {
  for (const ComparedSource& s : report.sources) {
    if (s.key == key) return s.otherwise;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::vector<Quantity> quantities(const ComparisonReport& report) {
  return {
      {"edge loss in the pair, % of length", [](const EdgeFigures& f) { return 100 * f.pair_loss; },
       100 * assumed(report, "edge_loss")},
      {"lateral shift common to both eyes (s), px",
       [](const EdgeFigures& f) { return f.common_px; }, assumed(report, "lateral_shift_px")},
      {"end points across the line, px", [](const EdgeFigures& f) { return f.corners.across_px; },
       assumed(report, "endpoint_sigma_px")},
      {"lines mismatched by " + report.matchers.front() + ", %", wrong_share,
       100 * assumed(report, "stereo_mismatch")}};
}

/// Bars of the groups of a table; a dashed line where the simulator's default is.
std::string bars(const ComparisonTable& table, const Quantity& quantity) {
  constexpr int row = 26, left = 165, right = 365, width = 460;
  double largest = std::isnan(quantity.assumed) ? 0 : quantity.assumed;
  for (const ComparisonGroup& group : table.groups) {
    const double value = quantity.of(group.figures);
    if (value > largest) largest = value;
  }
  if (!(largest > 0)) largest = 1;
  const auto x = [&](double value) { return left + (right - left) * value / largest; };
  const int height = row * static_cast<int>(table.groups.size()) + 18;
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 {} {}\" font-size=\"12\" role=\"img\" aria-label=\"{}\">",
                  width, height, quantity.title);
  if (!std::isnan(quantity.assumed) && quantity.assumed > 0) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1}\" stroke=\"#c2542d\" "
        "stroke-dasharray=\"4 3\" stroke-width=\"1.5\"/><text x=\"{0:.1f}\" y=\"{2}\" "
        "fill=\"#c2542d\" "
        "text-anchor=\"middle\">assumed {3:g}</text>",
        x(quantity.assumed), height - 18, height - 5, quantity.assumed);
  }
  int y = 0;
  for (const ComparisonGroup& group : table.groups) {
    const double value = quantity.of(group.figures);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", left - 6, y + 17,
                       group.name);
    if (std::isnan(value)) {
      svg +=
          fmt::format("<text x=\"{}\" y=\"{}\" fill=\"#77808c\">too few</text>", left + 4, y + 17);
    } else {
      svg += fmt::format(
          "<rect x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"16\" fill=\"#3f76b5\" "
          "fill-opacity=\".75\"/>"
          "<text x=\"{:.1f}\" y=\"{}\">{:.3g} <tspan fill=\"#77808c\">({})</tspan></text>",
          left, y + 5, std::max(1.0, x(value) - left), x(value) + 4, y + 17, value,
          group.figures.edges);
    }
    y += row;
  }
  return svg + "</svg>";
}

std::string number(double value, int decimals) {
  return std::isnan(value) ? "–" : fmt::format("{:.{}f}", value, decimals);
}

std::string sources_table(const ComparisonReport& report) {
  std::string html =
      "<div class=\"scroll\"><table><tr><th>source</th><th>shown</th><th>95 % over pairs</th>"
      "<th>n</th><th>assumed</th><th></th></tr>\n";
  for (const ComparedSource& s : report.sources) {
    const bool has_interval = !std::isnan(s.shown.interval.low);
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:g}</td><td "
        "class=\"note\">{}</td></tr>\n",
        s.key, s.shown.known() ? fmt::format("{:.4g}", s.shown.value) : "–",
        has_interval ? fmt::format("{:.4g} to {:.4g}", s.shown.interval.low, s.shown.interval.high)
                     : "–",
        s.shown.samples, s.otherwise, s.note);
  }
  return html + "</table></div>\n";
}

std::string group_row(const std::string& name, const EdgeFigures& f) {
  std::string row = fmt::format("<tr><td>{}</td><td>{}</td>", name, f.edges);
  for (const auto& [value, decimals] : {std::pair{100 * f.left_loss, 1},
                                        {100 * f.pair_loss, 1},
                                        {100 * f.kept_whole, 1},
                                        {100 * f.lost_whole, 1},
                                        {f.gaps, 2},
                                        {f.median_shift_px, 3},
                                        {f.common_px, 3},
                                        {f.independent_px, 3},
                                        {f.towards_brighter_px, 3},
                                        {100 * f.corners.found, 1},
                                        {f.corners.across_px, 3},
                                        {f.corners.along_px, 2},
                                        {f.occlusions.across_px, 3},
                                        {f.occlusions.along_px, 2}}) {
    row += "<td>" + number(value, decimals) + "</td>";
  }
  for (const MatchFigures& m : f.matchers) {
    row += fmt::format("<td>{} of {}</td><td>{}</td>", m.wrong, m.matched, number(m.wrong_px, 1));
  }
  return row + "</tr>\n";
}

std::string figures_table(const ComparisonReport& report) {
  std::string html =
      "<div class=\"scroll\"><table><tr><th>edges</th><th>n</th><th>left loss %</th><th>pair loss "
      "%</th>"
      "<th>whole %</th><th>lost %</th><th>gaps</th><th>|shift| px</th><th>common s</th>"
      "<th>indep. s</th><th>to brighter</th><th>ends found %</th><th>across px</th><th>along "
      "px</th>"
      "<th>T across</th><th>T along</th>";
  for (const std::string& name : report.matchers) {
    html += "<th>" + name + " wrong</th><th>by px</th>";
  }
  html += "</tr>\n" + group_row("all", report.all);
  for (const ComparisonTable& table : report.tables) {
    for (const ComparisonGroup& group : table.groups) {
      html += group_row(table.by + ": " + group.name, group.figures);
    }
  }
  return html + "</table></div>\n";
}

}  // namespace

std::string comparison_page(const ComparisonReport& report) {
  std::string html = page_head;
  html += "<h1>What images show of the sources of error</h1>\n<p>" + report.how + "</p>\n" +
          sources_table(report);
  const std::vector<Quantity> shown = quantities(report);
  for (const ComparisonTable& table : report.tables) {
    html += "<h2>By " + (table.by == "shown as" ? std::string("how an edge is shown") : table.by) +
            "</h2>\n<div class=\"cards\">\n";
    for (const Quantity& quantity : shown) {
      html += "<figure><figcaption>" + quantity.title + "</figcaption>" + bars(table, quantity) +
              "</figure>\n";
    }
    html += "</div>\n";
  }
  html += "<h2>All figures</h2>\n" + figures_table(report) +
          "<p>In brackets: the number of edges. Definitions: docs/images.md.</p>\n</body></html>\n";
  return html;
}

}  // namespace vernier::cli
