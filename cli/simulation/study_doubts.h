// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/session.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// What a reader of a study's results must know besides them.
struct StudyDoubts {
  std::vector<std::string> warnings;
  std::vector<std::string> doubts;  ///< reasons not to trust the results
};

/// In which cells trials have failed, nothing was seen, more answers are wrong than stated, or
/// calibrations failed, are doubtful or share their views, and which programs have changed.
StudyDoubts doubts_of(const Study& study, const StudyResults& results);

/// Warnings as such; the doubts make the result untrusted (exit code 3).
void tell(const StudyDoubts& found, Session& session);

/// The same of a stored study whose results are shown: all are warnings, but that it is not
/// finished.
void tell_stored(const StudyDoubts& found, const StudyResults& results, Session& session);

}  // namespace vernier::cli
