// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// Keys that are swept in any of the cells, in their order.
std::vector<std::string> swept_keys(const StudyResults& results);

/// The part of a key behind its dots, unless another of the keys has the same.
std::string short_key(const std::string& key, const std::vector<std::string>& keys);

/// The results of a study for the terminal, in lines of at most 80 characters: cells, one column
/// for each swept key, what is the same for all of them, comparisons, and what is missing.
std::string study_table(const Study& study, const StudyResults& results);

}  // namespace vernier::cli
