// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/session.h"
#include "sim/study/study.h"
#include "sim/world.h"

namespace vernier::cli {

/// The parts of the report page's data (cli/report/report_calibration.h has those of a rig).
Json report_study(const Study& study, const StudyResults& results);
Json report_world(const World& world);
/// The view of the first trial of a study's middle cell.
Json report_view(const Study& study);

/// Whether the folder has the page's script and plots. Both are made when Vernier is built, the one
/// by esbuild, the other by esbuild from plotly.js.
bool has_script(const std::filesystem::path& folder);
bool has_plots(const std::filesystem::path& folder);

/// Throws Error where the folder has no script, without which there can be no page.
void check_script(const std::filesystem::path& folder);

/// Fills the page's template. A page without plots says so and holds tables only.
std::string assemble_page(const std::filesystem::path& folder, const Json& data);

}  // namespace vernier::cli
