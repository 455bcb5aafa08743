// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources/sources_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "calib/base/text_lines.h"
#include "sim/sources.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {
namespace {

/// Four digits, more than any interval here justifies.
double rounded(double value) {
  return vernier::internal::to_real(fmt::format("{:.4g}", value)).value_or(value);
}

std::string text_of(const MeasuredValue& measured) {
  return measured.known() ? fmt::format("{:.4g}", measured.value) : "unknown";
}

SourceEntry reach_entry(const char* key,
                        const MeasuredValue& reach_px,
                        int wrong,
                        const char* what) {
  SourceEntry entry = source_entry(key, reach_px, what);
  if (!entry.written) entry.note = fmt::format("only {} mismatches", wrong);
  return entry;
}

SourceEntry lateral_shift_entry(const MeasuredLateralShift& shift, ShiftMode mode) {
  SourceEntry entry =
      source_entry("lateral_shift_px", shift.independent_px,
                   fmt::format("independent in each camera; the views differ by {:.3f} px (RMS)",
                               shift.relative_px.value));
  if (!entry.written || mode == ShiftMode::independent) return entry;
  entry.written = false;
  entry.note = fmt::format(
      "a shift common to both cameras is not observable in a pair; the independent part is "
      "{:.3f} px per camera",
      shift.independent_px.value);
  return entry;
}

/// Replaces control characters by blanks, for use in a comment.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, ' ');
  return text;
}

std::string interval_text(const MeasuredValue& measured) {
  if (std::isnan(measured.interval.low)) return "";
  return fmt::format("{:.4g} to {:.4g}; ", measured.interval.low, measured.interval.high);
}

std::string lines_of(const SourceEntry& entry, const MeasuredSources& sources, ShiftMode mode) {
  if (entry.key != "lateral_shift_px") return source_line(entry);
  if (entry.written) {
    const bool independent = mode == ShiftMode::independent;
    return (independent ? "lateral_shift_mode = \"independent\"\n" : "") + source_line(entry);
  }
  std::string text = source_line(entry);
  if (sources.lateral_shift.independent_px.known()) {
    text += fmt::format(
        "#   to use the difference between the cameras ({}{} segments):\n"
        "#   lateral_shift_mode = \"independent\"\n#   lateral_shift_px = {:.4g}\n",
        interval_text(entry.measured), entry.measured.samples,
        sources.lateral_shift.independent_px.value);
  }
  return text;
}

}  // namespace

SourceEntry source_entry(const char* key, const MeasuredValue& measured, std::string note) {
  const SourceParameter& parameter = *source_parameter(key);
  SourceEntry entry{key, measured, SourceSettings().*parameter.value, measured.known(),
                    std::move(note)};
  if (!entry.written) {
    entry.note = fmt::format("only {} samples", measured.samples);
    return entry;
  }
  entry.measured.value = rounded(std::clamp(measured.value, parameter.low, parameter.high));
  if (measured.value < parameter.low || measured.value > parameter.high) {
    entry.note += fmt::format("; measured {:.4g}, limited to the accepted range {:g} to {:g}",
                              measured.value, parameter.low, parameter.high);
  }
  return entry;
}

SourceEntry kept_entry(const char* key, std::string why) {
  return {key, {}, SourceSettings().*source_parameter(key)->value, false, std::move(why)};
}

std::string source_line(const SourceEntry& entry) {
  if (!entry.written) {
    return fmt::format("# {} = {:.4g}: default kept; {}\n", entry.key, entry.otherwise, entry.note);
  }
  const std::string value = fmt::format("{} = {}", entry.key, entry.measured.value);
  return fmt::format("{:<28}# {}n {}; default {:.4g}; {}\n", value, interval_text(entry.measured),
                     entry.measured.samples, entry.otherwise, entry.note);
}

std::vector<SourceEntry> source_entries(const MeasuredSources& sources, ShiftMode mode) {
  const MeasuredEdgeLoss& loss = sources.edge_loss;
  const MeasuredEndpoints& ends = sources.endpoints;
  const MeasuredCorners& corners = sources.corners;
  const MeasuredStereoMismatch& stereo = sources.stereo_mismatch;
  std::vector<SourceEntry> entries;
  entries.push_back(lateral_shift_entry(sources.lateral_shift, mode));
  entries.push_back(
      source_entry("edge_loss", loss.share,
                   fmt::format("fraction of left segments' length on no right segment; right "
                               "to left {}, on no edge point {}",
                               text_of(loss.to_left), text_of(loss.on_edges))));
  entries.push_back(source_entry(
      "endpoint_sigma_px", ends.across_px,
      fmt::format("across the line; along it {:.3f} px; {:.0f} % of segments, cut short, excluded",
                  ends.along_px.value, 100 * ends.broken)));
  entries.push_back(source_entry(
      "stereo_mismatch", stereo.share,
      fmt::format("fraction of matched lines; {} of them wrong by more than 3 px", stereo.wrong)));
  entries.push_back(reach_entry("stereo_mismatch_px", stereo.reach_px, stereo.wrong,
                                "± range with the median error of the mismatches"));
  entries.push_back(source_entry("corner_loss", corners.loss,
                                 "fraction of left corners not detected in the right image"));
  entries.push_back(source_entry(
      "corner_mismatch", corners.mismatch,
      fmt::format("fraction of matches; {} of them wrong by more than 1.5 px", corners.wrong)));
  entries.push_back(reach_entry("corner_mismatch_px", corners.reach_px, corners.wrong,
                                "radius of the disc with the median distance of the mismatches"));
  return entries;
}

std::string sources_toml(const MeasuredSources& sources, ShiftMode mode, const std::string& how) {
  std::string names;
  for (const std::string& name : sources.pairs) names += (names.empty() ? "" : ", ") + name;
  std::string text = fmt::format(
      "# Error sources measured by vernier characterise on {} pair{} with ground truth: {}\n"
      "# Comments give the 95 % interval of each value, {}.\n"
      "# Definitions and limits: docs/characterise.md\n{}[sources]\n",
      sources.pairs.size(), sources.pairs.size() == 1 ? "" : "s", one_line(names),
      sources.by_pair ? "over pairs"
                      : "over parts of these images; the variation between scenes may be larger",
      how.empty() ? "" : "# " + one_line(how) + "\n");
  for (const SourceEntry& entry : source_entries(sources, mode)) {
    text += lines_of(entry, sources, mode);
  }
  text += "# calibration and epipolar_reject_deg cannot be measured from images: defaults kept\n";
  return text;
}

}  // namespace vernier::sim::internal
