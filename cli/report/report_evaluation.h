// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "cli/program/session.h"

namespace vernier::cli {

/// Whether a folder contains an evaluation.
bool is_evaluation(const std::filesystem::path& folder);

/// Evaluation data for the report page, with pictures embedded as data URLs. Throws Error naming an
/// invalid file.
Json report_evaluation(const std::filesystem::path& folder);

/// The files that report_evaluation() reads.
std::vector<std::filesystem::path> evaluation_files(const std::filesystem::path& folder);

}  // namespace vernier::cli
