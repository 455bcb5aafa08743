// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_run.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

#include "cli/program/ending_signals.h"
#include "cli/program/session.h"
#include "cli/simulation/folder_claim.h"
#include "sim/study/study.h"

namespace vernier::cli {

void run_in_folder(const FolderClaim& claim,
                   const Study& study,
                   StudyRun job,
                   const std::string& what,
                   Session& session) {
  const StopSignal stop;
  int blocks_done = 0;
  job.stop = stop.token();
  std::optional<Progress> calibrations, ceilings, blocks;
  job.calibration_progress = [&](int done, int total) {
    if (!calibrations) calibrations.emplace(session, what + ": recorded calibrations");
    calibrations->update(done, total);
  };
  job.ceiling_progress = [&](int done, int total) {
    calibrations.reset();
    if (!ceilings) ceilings.emplace(session, what + ": world ceiling queries");
    ceilings->update(done, total);
  };
  job.progress = [&](int done, int total) {
    calibrations.reset();
    ceilings.reset();
    if (!blocks) blocks.emplace(session, what + ": blocks");
    blocks->update(done, total);
    blocks_done = done;
  };
  const auto end = [&] {
    calibrations.reset();
    blocks.reset();
    claim.withdraw(job.shard);
    stop.end(fmt::format("after {} blocks, which are stored; go on with: {}", blocks_done,
                         session.command));
  };
  job.on_stop = end;
  bool is_extended = false;
  job.on_start = [&] {
    claim.extend();
    is_extended = true;
  };
  try {
    run_study(study, job);
  } catch (...) {
    claim.withdraw(job.shard);
    throw;
  }
  if (stop.came()) end();
  if (!is_extended) claim.extend();  // no trial was missing
}

}  // namespace vernier::cli
