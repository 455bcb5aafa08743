// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <string>
#include <vector>

#include "sim/study/study_file.h"

namespace vernier::sim::internal {

/// The table [one_at_a_time] of a study: how much each source of error matters, by cells that
/// differ in one source only. All cells have the same queries and draws (common random numbers),
/// so each is compared in pairs with its reference.
struct OneAtATime {
  /// This source and no other; the reference has none. `epipolar_reject_deg` stays as it is set in
  /// both: without it lines along the epipolar line are placed, and every error counts for more.
  bool only = false;
  bool all_but = false;  ///< all sources but this; the reference has all
  bool swept = false;    ///< this source times each factor, beside all others; the same reference
  std::vector<std::string> sources;          ///< names; empty: all that are on and may act
  std::vector<double> factors = {0.5, 2.0};  ///< of `swept`, neither 0 nor 1
  std::string sources_place, factors_place;  ///< file and line of these keys, or of the table
};

/// Reads the table. Throws Error with file and line for unknown designs and sources, and factors
/// that are no positive numbers or are 1.
OneAtATime read_one_at_a_time(const toml::table& table, const std::string& place);

/// The cells of the designs around one cell, the references first: swept are "design" (as set, no
/// source, only, all but, swept), "source" and "value". Throws Error if a named source is off, a
/// value is out of the source's range, or no source is on.
std::vector<StudyCell> one_at_a_time(const StudyCell& cell, const OneAtATime& designs);

/// The source that a cell of a design switches or sweeps; empty if none.
std::string varied_source(const StudyCell& cell);

/// Whether a cell is of a design, and whether `reference` is what it is compared with.
bool has_design(const StudyCell& cell);
bool is_reference_of(const StudyCell& reference, const StudyCell& cell);

}  // namespace vernier::sim::internal
