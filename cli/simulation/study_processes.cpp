// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_processes.h"

#include <filesystem>
#include <optional>
#include <string>

#include "calib/error.h"
#include "cli/program/ending_signals.h"
#include "cli/program/session.h"
#include "cli/program/streams.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_inputs.h"
#include "sim/mpi/mpi_launch.h"
#include "sim/mpi/mpi_ranks.h"
#include "sim/study/rank_messages.h"
#include "sim/study/study.h"
#include "sim/study/study_ranks.h"

namespace vernier::cli {

StudyProcesses::StudyProcesses() {
  const std::optional<MpiLaunch> launch = mpi_launch();
  if (launch) ranks_ = mpi_ranks();
}

StudyProcesses::~StudyProcesses() { end(); }

void StudyProcesses::end() noexcept {
  if (ranks_ && ranks_->rank() == 0) end_ranks(*ranks_);
  ranks_.reset();
}

bool StudyProcesses::only_computes() const { return ranks_ && ranks_->rank() > 0; }

int StudyProcesses::threads(int asked) const {
  return ranks_ && asked == 0 ? ranks_->cores() : asked;
}

void StudyProcesses::compute(const std::filesystem::path& study_file,
                             int asked_threads,
                             Session& session) {
  const StopSignal stop;
  std::optional<Failed> failure;
  try {
    const Study study = load_study(study_file, session);
    serve_study(study, threads(asked_threads), *ranks_, stop.token());
  } catch (...) {
    failure = current_failure();
  }
  if (failure) tell_failure(*failure, *ranks_);
  if (stop.came()) stop.end("");
}

bool silence_other_process() noexcept {
  const std::optional<MpiLaunch> launch = mpi_launch();
  if (!launch || launch->rank == 0) return false;
  be_silent();
  return true;
}

void refuse_several_processes(const std::string& verb) {
  const std::optional<MpiLaunch> launch = mpi_launch();
  if (!launch) return;
  throw Error(verb, fmt::format("is the work of one process, and mpirun started {}", launch->size),
              "leave mpirun out");
}

}  // namespace vernier::cli
