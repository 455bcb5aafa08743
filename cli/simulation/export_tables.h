// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "calib/base/file_in_progress.h"
#include "cli/program/namespaces.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// Writes a table of the cells, CSV or .npy by the ending of `name` (docs/file-formats.md); with
/// `all_settings` those too that do not differ. Returns the number of rows.
std::size_t export_cells(const Study& study,
                         const StudyResults& results,
                         bool all_settings,
                         const std::string& name,
                         FileInProgress& file);

/// The same of the stored trials, block by block: memory does not grow with their number. Returns
/// the study's results without trials.
StudyResults export_trials(const Study& study,
                           const std::filesystem::path& folder,
                           const std::string& name,
                           FileInProgress& file);

}  // namespace vernier::cli
