// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/program/namespaces.h"
#include "cli/report/figure_svg.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// The figures of a study as on its page, each with the name of its file: success with its
/// intervals, and the median error, against the swept key with most numbers; one line for each
/// value of another key, and a panel for each combination of the rest. With two keys every panel
/// has one line and those of the others behind it. Rows where no key has numbers, and for designs
/// of one source at a time.
std::vector<std::pair<std::string, PaperFigure>> study_figures(const StudyResults& results);

}  // namespace vernier::cli
