// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/session.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::cli {

/// Whether text is a whole number that a double does not hold, as a large seed.
bool is_beyond_double(const std::string& text);

/// What a study tries: its name, the column of its error, that in words, and its unit.
Json system_json(const SystemKind& kind);

/// A setting as a JSON number, Boolean or string.
Json setting_json(const std::string& text);

/// The files of a study's folder that are read, which no output may replace.
std::vector<std::filesystem::path> study_folder_files(const std::filesystem::path& folder);

/// A cell's settings and statistics.
Json cell_json(const CellResult& cell);
/// Compares each cell with the closest previous one that has the same queries; p-values unadjusted
/// and adjusted by Holm's method.
Json comparisons_json(const StudyResults& results);
/// Success over swept worlds; empty if there are none.
Json over_worlds_json(const StudyResults& results);
Json study_json(const Study& study, const StudyResults& results);

/// "--shard 1/4, --shard 3/4", of many the first ten.
std::string shard_options(const std::vector<Shard>& shards);

/// "ψ_c = 1" for a sweep of the calibration error, otherwise the cell's label.
std::string short_label(const StudyCell& cell);

}  // namespace vernier::cli
