// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/sources.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {

/// A key of [sources] and what was measured of it.
struct SourceEntry {
  std::string key;
  MeasuredValue measured;  ///< not known: too few samples
  double otherwise = 0;    ///< the simulator's default
  bool written = false;    ///< else the default stays
  std::string note;        ///< what was measured, or why the default stays
};

/// The simulator's keys in the order in which they act. What cannot be measured keeps its default:
/// `calibration` and `epipolar_reject_deg` are not the images' to tell, and of `lateral_shift_px`
/// two simultaneous views tell only what is not common to both. `mode` says what is to be written:
/// common leaves the default, independent writes what the views differ by.
std::vector<SourceEntry> source_entries(const MeasuredSources& sources,
                                        ShiftMode mode = ShiftMode::common);

/// The same as a file: a table [sources] with a comment beside each key. A study reads it
/// by `file` in its own [sources], or copied into it (docs/file-formats.md). `how` is one more line
/// of its head: by what matcher and options they were measured.
std::string sources_toml(const MeasuredSources& sources,
                         ShiftMode mode = ShiftMode::common,
                         const std::string& how = "");

}  // namespace vernier::sim::internal
