// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "cli/program/session.h"

namespace vernier::cli {

/// Puts the results of several folders of one study into `target`, which is new, empty or has the
/// same study. Everything is read and compared before anything is written. Throws Error for parts
/// of different studies, or stores that disagree.
void merge_studies(const std::vector<std::filesystem::path>& parts,
                   const std::filesystem::path& target,
                   Session& session);

}  // namespace vernier::cli
