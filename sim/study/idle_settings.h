// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/sources.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"

/// Settings of a study that change nothing: a request that is not heard is refused, a source of
/// error that finds nothing to act on is told, as it describes images and not what looks at them.
namespace vernier::sim::internal {

/// "sources." and the name.
std::string key_of(const SourceParameter& source);

/// Why a setting, by its dotted key, changes no answer of a cell, for messages: "localiser.method
/// is \"pgh\"". Empty if it may change some, as far as the study file tells.
std::string why_idle(const std::string& key, const StudyCell& cell);

/// A source that acts in no cell.
struct IdleSource {
  std::string key, reason;
};

/// Throws Error, with file and line, for what changes no answer of any cell: a key that is swept, a
/// setting other than its default of anything but sources of error, and a source that
/// one_at_a_time.sources names; and for a cell that could answer nothing. Returns
/// the sources that the study file sets, to anything but 0 and their default, and that act nowhere.
std::vector<IdleSource> check_settings_act(const Study& study);

}  // namespace vernier::sim::internal
