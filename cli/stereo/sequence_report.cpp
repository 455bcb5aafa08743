// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/sequence_report.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "cli/program/session.h"
#include "cli/stereo/characterise_report.h"
#include "sim/sequence/lost_again.h"
#include "sim/sequence/measured_sequence.h"
#include "sim/sequence/sequence_file.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/sources_file.h"

namespace vernier::cli {

using sim::internal::LostAgain;
using sim::internal::MeasuredSequence;
using sim::internal::SequenceBand;
using sim::internal::SequenceFigures;

namespace {

struct NamedFigure {
  const char* name;
  MeasuredValue SequenceFigures::*value;
  const char* about;
};

constexpr std::array sequence_figures{
    NamedFigure{"loss", &SequenceFigures::loss, "of the length of expected lines"},
    NamedFigure{"lost_whole", &SequenceFigures::lost_whole, "of expected lines"},
    NamedFigure{"loss_of_found", &SequenceFigures::loss_of_found, "of the length of lines found"},
    NamedFigure{"pieces", &SequenceFigures::pieces, "segments on a line found"},
    NamedFigure{"end_across_px", &SequenceFigures::end_across_px, "of an end, across its line"},
    NamedFigure{"end_along_px", &SequenceFigures::end_along_px, "of an end, along its line"},
    NamedFigure{"cut_short", &SequenceFigures::cut_short, "of ends, more than 10 px apart"},
    NamedFigure{"false_edges", &SequenceFigures::not_confirmed, "of segments, in one view alone"},
    NamedFigure{"beside_lines", &SequenceFigures::beside_lines, "of segments, on no expected line"},
    NamedFigure{"mismatch", &SequenceFigures::mismatch, "of segments found, depth off by 5 sigma"}};

Json figures_json(const SequenceFigures& f) {
  Json json = Json::object();
  for (const NamedFigure& figure : sequence_figures)
    json[figure.name] = measured_json(f.*figure.value);
  return json;
}

Json bands_json(const std::vector<SequenceBand>& bands,
                const char* from,
                const char* to,
                double unit) {
  Json list = Json::array();
  for (const SequenceBand& band : bands) {
    Json json{{from, band.from / unit}, {to, json_number(band.to / unit)}};
    json.update(figures_json(band.figures));
    list.push_back(std::move(json));
  }
  return list;
}

Json lost_again_json(const std::vector<LostAgain>& bands) {
  Json list = Json::array();
  for (const LostAgain& band : bands) {
    Json json = measured_json(band.again);
    json["from_m"] = band.from_m;
    json["to_m"] = json_number(band.to_m);
    list.push_back(std::move(json));
  }
  return list;
}

constexpr double radians_of_degree = std::numbers::pi / 180;

std::string shown_figure(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-";
}

std::string shown_interval(const MeasuredValue& measured) {
  return std::isfinite(measured.interval.low)
             ? fmt::format("{:.3g} to {:.3g}", measured.interval.low, measured.interval.high)
             : "-";
}

std::string bands_text(const std::vector<SequenceBand>& bands, const char* what, double unit) {
  std::string text = fmt::format("\n{:<14}", what);
  const std::array columns{&SequenceFigures::loss, &SequenceFigures::pieces,
                           &SequenceFigures::end_across_px, &SequenceFigures::not_confirmed,
                           &SequenceFigures::mismatch};
  for (const char* name : {"loss", "pieces", "across px", "false edges", "mismatch"}) {
    text += fmt::format(" {:>24}", name);
  }
  text += '\n';
  for (const SequenceBand& band : bands) {
    text += fmt::format("{:<14}", std::isfinite(band.to)
                                      ? fmt::format("{:g} to {:g}", std::round(band.from / unit),
                                                    std::round(band.to / unit))
                                      : fmt::format("above {:g}", std::round(band.from / unit)));
    for (const auto column : columns) {
      const MeasuredValue& value = band.figures.*column;
      text += fmt::format(
          " {:>24}", value.known()
                         ? fmt::format("{} ({})", shown_figure(value.value), shown_interval(value))
                         : "-");
    }
    text += '\n';
  }
  return text;
}

std::string lost_again_text(const std::vector<LostAgain>& bands) {
  std::string text = "\nviews apart, m   of lines that one of two loses, lost by the other too\n";
  for (const LostAgain& band : bands) {
    const std::string range = std::isfinite(band.to_m)
                                  ? fmt::format("{:g} to {:g}", band.from_m, band.to_m)
                                  : fmt::format("above {:g}", band.from_m);
    text += fmt::format("{:<14} {:>9} {:>20} {:>8}\n", range, shown_figure(band.again.value),
                        shown_interval(band.again), band.again.samples);
  }
  return text;
}

}  // namespace

Json sequence_json(const MeasuredSequence& sequence) {
  Json sources = Json::object();
  for (const SourceEntry& entry : source_entries(sequence)) {
    Json json = measured_json(entry.measured);
    json["default"] = entry.otherwise;
    json["written"] = entry.written;
    json["note"] = entry.note;
    sources[entry.key] = std::move(json);
  }
  return {{"views", sequence.views},
          {"lines", sequence.lines},
          {"clusters", sequence.clusters},
          {"block_m", sequence.block_m},
          {"with_depth", sequence.with_depth},
          {"depths_agree", sequence.depths_agree},
          {"sources", sources},
          {"figures", figures_json(sequence.all)},
          {"turn_rad", json_number(sequence.turn_rad)},
          {"lost_again", lost_again_json(sequence.lost_again)},
          {"by_range", bands_json(sequence.by_range, "from_m", "to_m", 1)},
          {"by_length", bands_json(sequence.by_length, "from_px", "to_px", 1)},
          {"by_angle", bands_json(sequence.by_angle, "from_deg", "to_deg", radians_of_degree)}};
}

std::string sequence_text(const MeasuredSequence& sequence) {
  std::string text = fmt::format("{:<20} {:>9} {:>20} {:>8} {:>8}  {}\n", "source", "value",
                                 "95 % interval", "n", "default", "note");
  for (const SourceEntry& entry : source_entries(sequence)) {
    text += fmt::format("{:<20} {:>9} {:>20} {:>8} {:>8}  {}{}\n", entry.key,
                        shown_figure(entry.measured.value), shown_interval(entry.measured),
                        entry.measured.samples, shown_figure(entry.otherwise),
                        entry.written ? "" : "default used: ", entry.note);
  }
  text +=
      fmt::format("\n{} lines, {}, {} depth maps; intervals: bootstrap over {} blocks of the way\n",
                  sequence.lines, counted(static_cast<std::int64_t>(sequence.views), "view"),
                  sequence.with_depth ? "with" : "without", sequence.clusters);
  for (const NamedFigure& figure : sequence_figures) {
    const MeasuredValue& value = sequence.all.*figure.value;
    text += fmt::format("{:<14} {:>9} {:>20} {:>8}  {}\n", figure.name, shown_figure(value.value),
                        shown_interval(value), value.samples, figure.about);
  }
  return text + lost_again_text(sequence.lost_again) +
         bands_text(sequence.by_range, "range, m", 1) +
         bands_text(sequence.by_length, "length, px", 1) +
         bands_text(sequence.by_angle, "to sight, deg", radians_of_degree);
}

}  // namespace vernier::cli
