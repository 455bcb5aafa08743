// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "sim/experiment.h"

namespace vernier::sim::internal {

/// Of the reason of a trial that failed or is doubted as much is stored, bytes.
inline constexpr std::size_t longest_reason = 200;

/// A block as its row in a store holds it.
struct BlockRow {
  std::string cell;  ///< key
  int block = 0;
  std::array<int, 3> counted{};  ///< trials, those with an answer, successes
  std::string results;           ///< trials_text()
};

/// What a row holds of some trials, for users of SQL: how many, with an answer, successes.
std::array<int, 3> row_counts(const std::vector<TrialResult>& trials);

BlockRow block_row(std::string cell, int block, const std::vector<TrialResult>& trials);

/// The trials of a block as text, from which they are read back to the bit.
std::string trials_text(const std::vector<TrialResult>& trials);

/// Reads them back. Throws Error(`place`) for anything that trials_text does not write: another
/// number of fields, a number out of its range, trials that do not follow one another.
std::vector<TrialResult> parse_trials(const std::string& text, const std::string& place);

/// Checksum of the fields of a row, in order; any changed bit changes it.
std::string row_checksum(const std::vector<std::string>& fields);

}  // namespace vernier::sim::internal
