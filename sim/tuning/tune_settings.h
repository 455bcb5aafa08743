// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/study/study_file.h"
#include "sim/tuning/objective.h"
#include "sim/tuning/race.h"

namespace vernier::sim::internal {

/// The table [tune] of a study file (docs/file-formats.md).
struct TuneSettings {
  Objective objective = Objective::success;
  RaceOptions race;
  /// Swept keys that do not make candidates, beside world.file and study.seed: a candidate is
  /// judged by its mean over all of their values.
  std::vector<std::string> conditions;
  std::vector<std::string> confirm_worlds;  ///< files, none of them searched
  std::uint64_t confirm_seed = 0;  ///< none of those searched; the one after them if not given
  int confirm_trials = 0;          ///< in each of these worlds
};

/// Reads [tune] of the text that `study` was read from. Throws Error with file and line for a
/// missing table or key, an unknown one, a value out of its range, a world or seed to confirm on
/// that is searched, and a study that a race cannot run: with [one_at_a_time] or interval_width.
TuneSettings parse_tune(const std::string& text, const std::string& place, const StudyFile& study);

/// One of the settings that race: the cells that differ in conditions only.
struct Candidate {
  std::string label;  ///< keys and values
  std::vector<std::pair<std::string, std::string>> values;
  std::vector<int> cells;  ///< places in StudyFile::cells
};

/// In the order of the first cell of each. Throws Error(`place`) for fewer than two.
std::vector<Candidate> candidates_of(const StudyFile& study,
                                     const TuneSettings& settings,
                                     const std::string& place);

/// The study that confirms a candidate, as the text of a study file: its values, the sweep of the
/// conditions, the worlds, seed and trials to confirm on.
std::string confirmation_text(const std::string& text,
                              const std::string& place,
                              const Candidate& candidate,
                              const TuneSettings& settings);

}  // namespace vernier::sim::internal
