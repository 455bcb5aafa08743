// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/session.h"
#include "cli/simulation/tune_result.h"

namespace vernier::cli {

/// The result of a search in its folder.
inline constexpr const char* tune_result_file = "tune.json";

struct TuneOptions {
  std::string file, folder;
  int threads = 0;
  bool allow_other_instruction_set = false;
};

/// Races the study of a file, confirms the winner and its reference, or goes on with what the
/// folder holds of both. Throws Error, before anything is computed or written, for a file without a
/// race or worlds to confirm on, a world that is searched too, and a folder of something else.
TuneResult tune_study(const TuneOptions& options, Session& session);

}  // namespace vernier::cli
