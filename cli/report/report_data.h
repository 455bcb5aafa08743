// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/session.h"
#include "sim/study/study.h"
#include "sim/world.h"

namespace vernier::cli {

/// The number of trials of each cell that the page lists.
std::size_t listed_of_a_cell(const Study& study);

/// Data of the report page (for rigs, see cli/report/report_calibration.h).
Json report_study(const Study& study, const StudyResults& results);
Json report_world(const World& world);
/// The view of the first trial in a study's middle cell.
Json report_view(const Study& study);

/// Whether the folder has the page's script and the plots. Both are made by esbuild when Vernier is
/// built, the plots from plotly.js.
bool has_script(const std::filesystem::path& folder);
bool has_plots(const std::filesystem::path& folder);

/// Throws Error if the folder has no script, which every page needs.
void check_script(const std::filesystem::path& folder);

/// Fills the page template. Without plots, the page has tables only and a notice.
std::string assemble_page(const std::filesystem::path& folder, const Json& data);

}  // namespace vernier::cli
