// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/sequence_file.h"

#include <fmt/format.h>

#include "sim/sequence/lost_again.h"
#include "sim/sequence/measured_sequence.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/sources_file.h"

namespace vernier::sim::internal {
namespace {

/// False edges as a fraction of the true ones.
MeasuredValue of_true_ones(MeasuredValue share) {
  for (double* value : {&share.value, &share.interval.low, &share.interval.high}) {
    *value = *value / (1 - *value);
  }
  return share;
}

}  // namespace

std::vector<SourceEntry> source_entries(const MeasuredSequence& sequence) {
  const SequenceFigures& f = sequence.all;
  std::vector<SourceEntry> entries;
  entries.push_back(kept_entry("unseen", "an edge that no view shows is not there to be counted"));
  entries.push_back(source_entry("missed", f.lost_whole,
                                 "fraction of expected lines that a view does not show at all"));
  const LossesAlike& alike = sequence.alike;
  if (alike.correlation.known() && alike.correlation.interval.low > 0) {
    entries.push_back(source_entry("missed_alike", alike.correlation,
                                   "correlation of what two views at one place miss"));
    entries.push_back(source_entry("missed_alike_m", alike.side_m,
                                   "side of the places whose views miss alike, m"));
  } else {
    for (const char* key : {"missed_alike", "missed_alike_m"}) {
      entries.push_back(kept_entry(key, "losses of views near each other are not more alike"));
    }
  }
  entries.push_back(source_entry(
      "clutter", of_true_ones(f.not_confirmed),
      fmt::format("segments that no neighbouring view confirms, per one that is; {:.3g} of all are "
                  "on no line that enough other views saw",
                  f.beside_lines.value)));
  entries.push_back(
      kept_entry("lateral_shift_px", "a shift that all views share moves the joined line with it"));
  entries.push_back(kept_entry("merge_px", "the distance below which two lines become one"));
  entries.push_back(source_entry("edge_loss", f.loss_of_found,
                                 fmt::format("fraction of the length of lines that are found; of "
                                             "all expected lines {:.3g} is missing",
                                             f.loss.value)));
  entries.push_back(source_entry(
      "endpoint_sigma_px", f.end_across_px,
      fmt::format("across the line; along it {:.3g} px, and {:.0f} % of ends are cut short",
                  f.end_along_px.value, 100 * f.cut_short.value)));
  entries.push_back(source_entry("stereo_mismatch", f.mismatch,
                                 "fraction of found segments whose depth is off by 5 sigma"));
  entries.push_back(
      kept_entry("stereo_mismatch_px", "depths that are off have no disparity without a baseline"));
  for (const char* key : {"corner_loss", "corner_mismatch", "corner_mismatch_px"}) {
    entries.push_back(kept_entry(key, "corners are not in the file of segments"));
  }
  return entries;
}

std::string sources_toml(const MeasuredSequence& sequence, const std::string& how) {
  std::string text = fmt::format(
      "# Error sources measured by vernier characterise --sequence: {} lines seen in {} views, {}\n"
      "# Comments give the 95 % interval of each value, by a bootstrap over {} blocks of the "
      "way{}.\n"
      "# Definitions and limits: docs/characterise.md\n{}[sources]\n",
      sequence.lines, sequence.views,
      sequence.with_depth ? "with depth maps" : "without depth maps", sequence.clusters,
      sequence.block_m > 0 ? fmt::format(" of {:g} m", sequence.block_m) : "",
      how.empty() ? "" : "# " + how + "\n");
  for (const SourceEntry& entry : source_entries(sequence)) text += source_line(entry);
  text += "# calibration and epipolar_reject_deg cannot be measured from images: defaults kept\n";
  return text;
}

}  // namespace vernier::sim::internal
