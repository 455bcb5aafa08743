// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "cli/program/session.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"

namespace vernier::cli {

/// Loads a study file with the world and rig it names (relative to it, or shipped).
Study load_study(const std::filesystem::path& file, Session& session);

/// A study's folder holds copies of study.toml, world.world.toml and rig.json beside its stores,
/// and of the file that its [sources] names as sources.toml, so that it can be resumed, merged and
/// reported wherever it is moved.
void keep_inputs(const std::filesystem::path& study_file, const std::filesystem::path& folder);
Study open_folder(const std::filesystem::path& folder, Session& session);

/// The settings that differ between cells, and the first cell's whole settings.
Json cell_json(const CellResult& cell);
/// Each cell against the nearest one before it with the same queries; the p-values as they are and
/// adjusted for their number by Holm's method.
Json comparisons_json(const StudyResults& results);
Json study_json(const Study& study, const StudyResults& results);
std::string study_table(const Study& study, const StudyResults& results);

/// "psi_c = 1" for the usual sweep, else the cell's label.
std::string short_label(const StudyCell& cell);

}  // namespace vernier::cli
