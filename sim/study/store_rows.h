// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/experiment.h"

namespace vernier::sim::internal {

/// The trials of a block as text, from which they are read back to the bit.
std::string trials_text(const std::vector<TrialResult>& trials);

/// Reads them back. Throws Error(`place`) for anything that trials_text does not write: another
/// number of fields, a number out of its range, trials that do not follow one another.
std::vector<TrialResult> parse_trials(const std::string& text, const std::string& place);

/// Checksum of the fields of a row, in order; any changed bit changes it.
std::string row_checksum(const std::vector<std::string>& fields);

}  // namespace vernier::sim::internal
