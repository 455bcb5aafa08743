// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/sources.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {

/// A key of [sources] and its measured value.
struct SourceEntry {
  std::string key;
  MeasuredValue measured;  ///< unknown: too few samples
  double otherwise = 0;    ///< the simulator's default
  bool written = false;    ///< false: the default is kept
  std::string note;        ///< what was measured, or why the default is kept
};

/// A key with what was measured of it, limited to what is accepted; the default, and why, with too
/// few samples.
SourceEntry source_entry(const char* key, const MeasuredValue& measured, std::string note);
/// A key that keeps its default, and why.
SourceEntry kept_entry(const char* key, std::string why);
/// Its line in the file: the value, or the default as a comment.
std::string source_line(const SourceEntry& entry);

/// The simulator's keys in the order in which they act. Keys that cannot be measured keep their
/// default: `calibration` and `epipolar_reject_deg` cannot be measured from images, and
/// `lateral_shift_px` only as far as it differs between two simultaneous views. `mode` selects what
/// is written: common keeps the default, independent writes the difference between the views.
std::vector<SourceEntry> source_entries(const MeasuredSources& sources,
                                        ShiftMode mode = ShiftMode::common);

/// The same as a file: a table [sources] with a comment for each key. A study refers to it by
/// `file` in its own [sources], or its text is copied there (docs/file-formats.md). `how` is an
/// additional line of the header: the matcher and options used.
std::string sources_toml(const MeasuredSources& sources,
                         ShiftMode mode = ShiftMode::common,
                         const std::string& how = "");

}  // namespace vernier::sim::internal
