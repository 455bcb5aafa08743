// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_scenes.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"

namespace vernier::sim::internal {

/// Stores what becomes of the calibrations of trials 0 to 99 of each cell with [calibration]
/// (record_of) that has no such note yet: once for cells that share them, and of several shards by
/// the one whose block the first trials are. Computed on `run.threads`; the note does not depend on
/// their number.
///
/// Asked to stop, it begins no further calibration and stores no part of a note. With ranks it does
/// not wait for those that run: after 0.3 s it closes the store and calls `run.on_stop`.
void record_calibrations(const Study& study,
                         const StudyWork& work,
                         const StudyRun& run,
                         const StoredResults& stored,
                         StudyScenes& scenes,
                         std::optional<StudyStore>& store);

}  // namespace vernier::sim::internal
