// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "cli/program/text_table.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::cli {

/// A quantity in any unit, to three digits; a dash where there is none.
std::string significant(double value);

/// What other systems than localisers measure besides their error, over the answered trials of each
/// cell: medians, and the root mean square of what may have either sign. `rows` names the cells.
std::string measured_table(const StudyResults& results, std::vector<TextColumn> rows);

/// Whether the estimator may be told another rig than the true one.
bool uses_told_rigs(const SystemKind& kind);

/// The largest error of a success, with its unit; of cells that differ, the key that says it.
std::string limit_text(const StudyFile& study);

/// What counts as a success of another system than a localiser, and how the interval is made.
std::string system_conditions(const Study& study, const std::string& worlds);

}  // namespace vernier::cli
