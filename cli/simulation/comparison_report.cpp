// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/comparison_report.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "cli/program/session.h"
#include "sim/image_comparison/compared_sources.h"
#include "sim/image_comparison/comparison_figures.h"
#include "sim/image_comparison/edge_sample.h"
#include "sim/sources/measured_sources.h"

namespace vernier::cli {
namespace {

Json ends_figures_json(const EndFigures& ends) {
  return {{"ends", ends.ends},
          {"found", json_number(ends.found)},
          {"across_px", json_number(ends.across_px)},
          {"along_px", json_number(ends.along_px)},
          {"along_mean_px", json_number(ends.along_mean_px)}};
}

Json figures_json(const EdgeFigures& f, const std::vector<std::string>& matchers) {
  Json json = {{"edges", f.edges},
               {"length_px", json_number(f.length_px)},
               {"left_loss", json_number(f.left_loss)},
               {"pair_loss", json_number(f.pair_loss)},
               {"kept_whole", json_number(f.kept_whole)},
               {"lost_whole", json_number(f.lost_whole)},
               {"gaps", json_number(f.gaps)},
               {"longest_gap", json_number(f.longest_gap)},
               {"shifted", f.shifted},
               {"common_shift_px", json_number(f.common_px)},
               {"independent_shift_px", json_number(f.independent_px)},
               {"median_shift_px", json_number(f.median_shift_px)},
               {"towards_brighter_px", json_number(f.towards_brighter_px)},
               {"corner_ends", ends_figures_json(f.corners)},
               {"occluded_ends", ends_figures_json(f.occlusions)}};
  for (std::size_t m = 0; m < matchers.size(); ++m) {
    const MatchFigures& match = f.matchers[m];
    json["matchers"][matchers[m]] = {{"lines", match.lines},
                                     {"matched", match.matched},
                                     {"wrong", match.wrong},
                                     {"wrong_px", json_number(match.wrong_px)}};
  }
  return json;
}

/// A number in a column of a table; a dash where there is none.
std::string cell(double value, int width, int decimals) {
  return std::isnan(value) ? fmt::format("{:>{}}", "-", width)
                           : fmt::format("{:>{}.{}f}", value, width, decimals);
}

std::string source_line(const ComparedSource& s) {
  const std::string interval =
      std::isnan(s.shown.interval.low)
          ? "-"
          : fmt::format("{:.4g} to {:.4g}", s.shown.interval.low, s.shown.interval.high);
  const std::string value = s.shown.known() ? fmt::format("{:.4g}", s.shown.value) : "-";
  return fmt::format("{:<20}{:>9}{:>23}{:>8}{:>9g}  {}\n", s.key, value, interval, s.shown.samples,
                     s.otherwise, s.note);
}

std::string group_line(const std::string& name, const EdgeFigures& f, std::size_t matchers) {
  std::string line = fmt::format("{:<24}{:>7}", name, f.edges);
  line += cell(100 * f.left_loss, 8, 1) + cell(100 * f.pair_loss, 8, 1) +
          cell(100 * f.lost_whole, 8, 1) + cell(f.median_shift_px, 8, 3) + cell(f.common_px, 8, 3) +
          cell(f.independent_px, 8, 3) + cell(f.corners.across_px, 8, 3) +
          cell(f.corners.along_px, 8, 2) + cell(100 * f.corners.found, 8, 1) +
          cell(f.occlusions.along_px, 8, 2);
  for (std::size_t m = 0; m < matchers; ++m) {
    const MatchFigures& match = f.matchers[m];
    line += fmt::format("{:>7}/{:<5}", match.wrong, match.matched);
  }
  return line + "\n";
}

}  // namespace

ComparisonReport comparison_report(const ComparedEdges& compared,
                                   const std::string& how,
                                   std::uint64_t seed) {
  MeasuringOptions measuring;
  measuring.bootstrap.seed = seed;
  ComparisonReport report;
  report.matchers = compared.matchers;
  report.pairs = compared.pairs();
  for (const auto& lengths : compared.false_px) {
    report.false_segments += static_cast<int>(lengths.size());
  }
  report.sources = compared_sources(compared, 0, measuring);
  report.all = edge_figures(compared, [](const EdgeSample&) { return true; });
  report.tables = comparison_tables(compared);
  report.unseen_again = unseen_again(compared);
  report.how = how;
  return report;
}

Json comparison_json(const ComparisonReport& report) {
  Json json = {{"format", "vernier/comparison"},
               {"version", 1},
               {"how", report.how},
               {"pairs", report.pairs},
               {"false_segments", report.false_segments},
               {"unseen_again", json_number(report.unseen_again)}};
  for (const ComparedSource& s : report.sources) {
    json["sources"][s.key] = {
        {"shown", json_number(s.shown.value)},
        {"interval_95", {json_number(s.shown.interval.low), json_number(s.shown.interval.high)}},
        {"samples", s.shown.samples},
        {"default", s.otherwise}};
  }
  json["all"] = figures_json(report.all, report.matchers);
  for (const ComparisonTable& table : report.tables) {
    Json groups = Json::array();
    for (const ComparisonGroup& group : table.groups) {
      Json entry = figures_json(group.figures, report.matchers);
      entry["group"] = group.name;
      groups.push_back(entry);
    }
    json["by"][table.by] = groups;
  }
  return json;
}

std::string comparison_text(const ComparisonReport& report) {
  std::string text = fmt::format("{:<20}{:>9}{:>23}{:>8}{:>9}\n", "source", "shown",
                                 "95 % over pairs", "n", "default");
  for (const ComparedSource& s : report.sources) text += source_line(s);
  if (!std::isnan(report.unseen_again)) {
    text += fmt::format(
        "an edge unseen in one view is unseen in {:.0f} % of the other views of its segment\n",
        100 * report.unseen_again);
  }
  std::string head = fmt::format("\n{:<24}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
                                 "", "edges", "left %", "pair %", "none %", "|shift|", "common",
                                 "indep.", "across", "along", "ends %", "T along");
  for (const std::string& name : report.matchers) head += fmt::format("{:>13}", name);
  text += head + "\n" + group_line("all", report.all, report.matchers.size());
  for (const ComparisonTable& table : report.tables) {
    text += table.by + "\n";
    for (const ComparisonGroup& group : table.groups) {
      text += group_line("  " + group.name, group.figures, report.matchers.size());
    }
  }
  return text +
         "left %, pair %: length on no segment of the left, of both images; none %: edges of which "
         "both show nothing;\nshifts and ends in px; ends %: of segments of the world that end "
         "within "
         "3 px of where they do; T: at occlusions;\nmatchers: lines more than 3 px wrong, of those "
         "matched\n";
}

}  // namespace vernier::cli
