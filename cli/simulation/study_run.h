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

/// Says in which cells trials have failed: a reason not to trust the results, but a result where a
/// calibration has.
void tell_failed_trials(const StudyResults& results, Session& session);

/// Doubts cells whose calibrations share most of their real views with one another, and with the
/// true rig where it is of all of them: they err by less than fresh ones.
void tell_shared_views(const Study& study, Session& session);

/// Says in which cells nothing that localises was seen in any trial; where that is so in all of
/// them, a reason not to trust them.
void tell_unseen_worlds(const StudyResults& results, Session& session);

/// Says in which cells more answers are wrong than the localiser states, by more than chance: at
/// least twice as many at 98 % confidence.
void tell_understated_errors(const StudyResults& results, Session& session);

/// Says which programs of the user's own were others at the run.
void tell_changed_programs(const StudyResults& results, Session& session);

/// Says which cells have not a single calibration to tell: a reason not to trust them.
void tell_failed_calibrations(const StudyResults& results, Session& session);

}  // namespace vernier::cli
