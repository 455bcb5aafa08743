// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/ceiling.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/told/fresh_calibrations.h"

/// Under which keys the parts of a study are stored, and the world ceilings that its notes hold.
namespace vernier::sim::internal {

/// Every setting in effect, by its dotted key: identifies a cell.
std::map<std::string, std::string> settings_of(const ExperimentSettings& settings);

/// Part of the key of every cell: incremented when trials of the same settings and seed give other
/// results, so that a store begun before is not gone on with. 2: calibration errors are drawn in
/// stable parameters. tests/sim/study/results_version_test.cpp tells when it must be.
inline constexpr int results_version = 2;

/// The same of the method `lines` alone, also where a default changes, for those are not part of a
/// key. 9: views of few lines are not believed.
inline constexpr int lines_version = 9;

/// Everything that a cell's results depend on, as text: the key under which they are stored. Blocks
/// of another size use other maps per trial and are therefore stored under another key.
std::string cell_key(const Study& study, const StudyCell& cell);

/// The same without the content of programs' files, to find results of a program that has changed.
std::string without_program_files(const std::string& cell_key);

/// Everything that the noise-free views of the map depend on, but the true rig, which is one.
std::string looks_key(const StudyCell& cell);

/// What the ceiling of a cell depends on.
std::string ceiling_key(const Study& study, const StudyCell& cell);

/// What the calibrations of a cell with [calibration] depend on.
std::string calibration_key(const Study& study, const StudyCell& cell);

/// What became of a cell's calibrations, as a note, and read back. Throws Error for a damaged note.
StoreNotes::value_type calibration_note(const std::string& calibration,
                                        const CalibrationRecord& record);
std::optional<CalibrationRecord> noted_calibrations(const StoreNotes& notes,
                                                    const std::string& calibration);

/// Number of a ceiling's queries: as many as the trials of all cells that share it, up to 5,000, so
/// that its cost stays a small part of the study's. They are the queries of trials 0, 1, ….
int ceiling_queries(const Study& study, const std::string& ceiling);

/// Queries that one run has computed, as a note: under a key of its own, since shards and resumed
/// runs have other parts.
StoreNotes::value_type ceiling_part(const std::string& ceiling, const QueryCeilings& of_query);

/// What the notes have of a ceiling's queries. Throws Error if two parts disagree on one.
QueryCeilings noted_queries(const Study& study,
                            const StoreNotes& notes,
                            const std::string& ceiling);

/// std::nullopt until all queries are stored.
std::optional<WorldCeiling> noted_ceiling(const Study& study,
                                          const StoreNotes& notes,
                                          const std::string& ceiling);

}  // namespace vernier::sim::internal
