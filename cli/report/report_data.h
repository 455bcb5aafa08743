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

/// Data of the report page (for rigs, see cli/report/report_calibration.h).
Json report_study(const Study& study, const StudyResults& results);
Json report_world(const World& world);
/// The view of the first trial in a study's middle cell.
Json report_view(const Study& study);

/// Whether pages made from the folder's files have plots.
bool has_plots(const std::filesystem::path& folder);

/// Fills the page template. Without plots, the page has tables only and a notice.
std::string assemble_page(const std::filesystem::path& folder, const Json& data);

}  // namespace vernier::cli
