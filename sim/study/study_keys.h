// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"

/// Under which keys the parts of a study are stored, and the world ceilings that its notes hold.
namespace vernier::sim::internal {

/// Every setting in effect, by its dotted key: identifies a cell.
std::map<std::string, std::string> settings_of(const ExperimentSettings& settings);

/// Everything that a cell's results depend on, as text: the key under which they are stored. Blocks
/// of another size use other maps per trial and are therefore stored under another key.
std::string cell_key(const Study& study, const StudyCell& cell);

/// Everything that the noise-free views of the map depend on.
std::string looks_key(const ExperimentSettings& settings);

std::string ceiling_key(const Study& study, const ExperimentSettings& settings);
/// One query's share of a ceiling whose queries are shared among shards.
std::string query_key(const std::string& ceiling, int query);
/// The ceiling is the mean over this many of a cell's queries.
int ceiling_queries(const Study& study);

/// What the notes have of a ceiling's queries, not a number for the others.
std::vector<double> noted_queries(const Study& study,
                                  const StoreNotes& notes,
                                  const std::string& key);
/// The sum is in the order of the queries, whichever was done first.
double mean_of_queries(const std::vector<double>& of_query);
/// Not a number where the notes lack it or one of its queries.
double noted_ceiling(const Study& study, const StoreNotes& notes, const std::string& key);

}  // namespace vernier::sim::internal
