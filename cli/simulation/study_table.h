// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/namespaces.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// The results of a study for the terminal, in lines of at most 80 characters: cells, one column
/// for each swept key, what is the same for all of them, comparisons, and what is missing.
std::string study_table(const Study& study, const StudyResults& results);

}  // namespace vernier::cli
