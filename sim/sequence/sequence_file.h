// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/sequence/measured_sequence.h"
#include "sim/sources/sources_file.h"

namespace vernier::sim::internal {

/// The simulator's keys in the order in which they act, with what a sequence measures of them; the
/// others keep their default, and the note says why.
std::vector<SourceEntry> source_entries(const MeasuredSequence& sequence);

/// The same as a file with a table [sources] (sim/sources/sources_file.h). `how` is an additional
/// line of the header.
std::string sources_toml(const MeasuredSequence& sequence, const std::string& how = "");

}  // namespace vernier::sim::internal
