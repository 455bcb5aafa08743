// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "cli/program/session.h"

namespace vernier::cli {

/// Whether a folder holds an evaluation.
bool is_evaluation(const std::filesystem::path& folder);

/// The evaluation's part of the report page's data: its file, pictures as data addresses in it.
/// Throws Error naming a file that is not what it should be.
Json report_evaluation(const std::filesystem::path& folder);

/// The files that it reads.
std::vector<std::filesystem::path> evaluation_files(const std::filesystem::path& folder);

}  // namespace vernier::cli
