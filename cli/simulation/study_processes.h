// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "cli/program/session.h"
#include "sim/mpi/mpi_ranks.h"
#include "sim/study/communicator.h"

namespace vernier::cli {

/// The processes that mpirun started for one study; a single one without mpirun. Rank 0 computes
/// too.
class StudyProcesses {
 public:
  /// Starts MPI if mpirun started several. Throws Error if Vernier was built without it.
  StudyProcesses();
  /// Ends as end() does.
  ~StudyProcesses();
  StudyProcesses(const StudyProcesses&) = delete;
  StudyProcesses& operator=(const StudyProcesses&) = delete;

  /// Whether this process only computes for rank 0.
  bool only_computes() const;
  /// Does so until rank 0 tells the end, or a signal comes. What fails here is thrown by rank 0.
  void compute(const std::filesystem::path& study_file, int threads, Session& session);
  /// Rank 0: the others, for StudyRun; null if there are none.
  Communicator* others() { return ranks_.get(); }
  /// Number of threads, if the user asked for this one (0: all cores, divided among the processes
  /// of a machine).
  int threads(int asked) const;
  /// Tells the others the end, waits for them and ends MPI.
  void end() noexcept;

 private:
  std::unique_ptr<MpiRanks> ranks_;  // null without mpirun
};

/// Makes all processes but rank 0 print nothing; whether this is one of them.
bool silence_other_process() noexcept;

/// Throws Error if mpirun started several processes, for what one process does.
void refuse_several_processes(const std::string& verb);

}  // namespace vernier::cli
