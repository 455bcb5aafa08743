// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/session.h"
#include "cli/simulation/folder_claim.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// Runs a study in its folder until it is done or a signal comes, which ends the program after
/// saying how to go on; reports how far it is. `what` begins these lines: "study".
void run_in_folder(const FolderClaim& claim,
                   const Study& study,
                   StudyRun job,
                   const std::string& what,
                   Session& session);

}  // namespace vernier::cli
