// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/characterise_report.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/interval.h"
#include "cli/program/session.h"
#include "sim/sources.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/sources_file.h"

namespace vernier::cli {

Json measured_json(const MeasuredValue& measured) {
  return {
      {"value", json_number(measured.value)},
      {"interval_95", {json_number(measured.interval.low), json_number(measured.interval.high)}},
      {"n", measured.samples}};
}

namespace {

/// Range of a source's values over the pairs.
Interval over_pairs(const CharacteriseReport& report, std::size_t source) {
  Interval range{std::numeric_limits<double>::quiet_NaN(),
                 std::numeric_limits<double>::quiet_NaN()};
  for (const MeasuredSources& pair : report.each) {
    const double value = source_entries(pair, report.mode)[source].measured.value;
    range.low = std::fmin(range.low, value);
    range.high = std::fmax(range.high, value);
  }
  return range;
}

Json sources_json(const CharacteriseReport& report) {
  Json json = Json::object();
  const std::vector<SourceEntry> entries = source_entries(report.sources, report.mode);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Json entry = measured_json(entries[i].measured);
    const Interval range = over_pairs(report, i);
    entry["over_pairs"] = {json_number(range.low), json_number(range.high)};
    entry["default"] = entries[i].otherwise;
    entry["written"] = entries[i].written;
    entry["note"] = entries[i].note;
    json[entries[i].key] = std::move(entry);
  }
  return json;
}

Json edges_json(const MeasuredSources& s) {
  const MeasuredEdgeLoss& loss = s.edge_loss;
  const MeasuredLateralShift& shift = s.lateral_shift;
  const MeasuredEndpoints& ends = s.endpoints;
  return {{"edge_loss",
           {{"left_to_right", measured_json(loss.share)},
            {"right_to_left", measured_json(loss.to_left)},
            {"on_no_edge", measured_json(loss.on_edges)},
            {"chance", loss.chance},
            {"segments_lost_whole", loss.whole},
            {"segments_without_loss", loss.none},
            {"gaps_of_the_others", loss.gaps},
            {"longest_gap_share", loss.longest_gap}}},
          {"lateral_shift",
           {{"independent_px", measured_json(shift.independent_px)},
            {"relative_rms_px", measured_json(shift.relative_px)},
            {"towards_brighter_px", measured_json(shift.towards_px)},
            {"truth_error_px", json_number(shift.truth_px)},
            {"beyond", shift.beyond}}},
          {"endpoints",
           {{"across_px", measured_json(ends.across_px)},
            {"along_px", measured_json(ends.along_px)},
            {"cut_short", ends.broken},
            {"outliers", ends.outliers}}}};
}

Json matches_json(const MeasuredSources& s) {
  Json bins = Json::array();
  for (const MismatchByDisparity& bin : s.stereo_mismatch.by_disparity) {
    bins.push_back({{"from_px", bin.from_px},
                    {"to_px", bin.to_px},
                    {"lines", bin.lines},
                    {"wrong", bin.wrong},
                    {"share", measured_json(bin.share)}});
  }
  return {{"corners",
           {{"loss", measured_json(s.corners.loss)},
            {"chance", s.corners.chance},
            {"mismatch", measured_json(s.corners.mismatch)},
            {"wrong", s.corners.wrong},
            {"reach_px", measured_json(s.corners.reach_px)}}},
          {"stereo_mismatch",
           {{"share", measured_json(s.stereo_mismatch.share)},
            {"wrong", s.stereo_mismatch.wrong},
            {"wrong_occluded", s.stereo_mismatch.occluded},
            {"reach_px", measured_json(s.stereo_mismatch.reach_px)},
            {"unmatched", s.stereo_mismatch.unmatched},
            {"by_disparity", bins}}}};
}

std::string figure_or_dash(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-";
}

std::string range(const Interval& interval) {
  return std::isfinite(interval.low) ? fmt::format("{:.3g} to {:.3g}", interval.low, interval.high)
                                     : "-";
}

std::string details(const MeasuredSources& s) {
  const MeasuredEdgeLoss& loss = s.edge_loss;
  std::string text = fmt::format(
      "edges: {:.0f} % of segments lost completely, {:.0f} % without loss, {:.2f} gaps in the "
      "others; {:.1f} % of the length is on no edge\n",
      100 * loss.whole, 100 * loss.none, loss.gaps, 100 * loss.on_edges.value);
  text += fmt::format(
      "views: relative shift {} px (rms), {} px towards the brighter side; {:.1f} % of segments "
      "are outliers; ground truth error {} px along the row\n",
      figure_or_dash(s.lateral_shift.relative_px.value),
      figure_or_dash(s.lateral_shift.towards_px.value), 100 * s.lateral_shift.beyond,
      figure_or_dash(s.lateral_shift.truth_px));
  text += fmt::format(
      "endpoints: {} px across, {} px along; {:.0f} % of segments truncated in one view, {:.1f} % "
      "of the others are outliers\n",
      figure_or_dash(s.endpoints.across_px.value), figure_or_dash(s.endpoints.along_px.value),
      100 * s.endpoints.broken, 100 * s.endpoints.outliers);
  text += fmt::format(
      "lines: {:.1f} % unmatched; {} wrong, {} of them not visible in the right image\n",
      100 * s.stereo_mismatch.unmatched, s.stereo_mismatch.wrong, s.stereo_mismatch.occluded);
  for (const MismatchByDisparity& bin : s.stereo_mismatch.by_disparity) {
    text += fmt::format("  disparity {:>5.0f} to {:>4.0f} px: {:>3} of {:>5} lines wrong, {}\n",
                        bin.from_px, bin.to_px, bin.wrong, bin.lines, range(bin.share.interval));
  }
  return text;
}

}  // namespace

Json report_json(const CharacteriseReport& report) {
  Json json{{"pairs", report.sources.pairs},
            {"clusters", report.sources.clusters},
            {"clustered_by", report.sources.by_pair ? "pair" : "part of an image"},
            {"matcher", report.matcher},
            {"lateral_shift_mode", report.mode == ShiftMode::common ? "common" : "independent"},
            {"sources", sources_json(report)},
            {"figures", edges_json(report.sources)}};
  json["figures"].update(matches_json(report.sources));
  json["scenes"] = Json::array();
  for (const MeasuredSources& pair : report.each) {
    Json scene{{"name", pair.pairs.front()}};
    for (const SourceEntry& entry : source_entries(pair, report.mode)) {
      scene[entry.key] = json_number(entry.measured.value);
    }
    json["scenes"].push_back(std::move(scene));
  }
  return json;
}

std::string report_text(const CharacteriseReport& report) {
  std::string text = fmt::format("{:<20} {:>9} {:>18} {:>18} {:>7} {:>8}  {}\n", "source", "value",
                                 "95 % interval", "over pairs", "n", "default", "note");
  const std::vector<SourceEntry> entries = source_entries(report.sources, report.mode);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const SourceEntry& entry = entries[i];
    text += fmt::format("{:<20} {:>9} {:>18} {:>18} {:>7} {:>8}  {}{}\n", entry.key,
                        figure_or_dash(entry.measured.value), range(entry.measured.interval),
                        range(over_pairs(report, i)), entry.measured.samples,
                        figure_or_dash(entry.otherwise),
                        entry.written ? "" : "default used: ", entry.note);
  }
  return text +
         fmt::format("intervals: bootstrap over {} {}\n", report.sources.clusters,
                     report.sources.by_pair ? "pairs" : "parts of images") +
         details(report.sources);
}

}  // namespace vernier::cli
