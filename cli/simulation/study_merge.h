// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "cli/program/session.h"
#include "sim/study/instruction_sets.h"

namespace vernier::cli {

/// Puts the results of several folders of one study into `target`, which is new, empty or has the
/// same study. Everything is read and compared before anything is written, and nothing is kept in
/// memory but which blocks there are. Throws Error for parts of different studies, stores that
/// disagree, and stores of different instruction sets unless that is allowed.
void merge_studies(const std::vector<std::filesystem::path>& parts,
                   const std::filesystem::path& target,
                   OtherInstructionSets others,
                   Session& session);

}  // namespace vernier::cli
