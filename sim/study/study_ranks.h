// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "sim/study/communicator.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/rank_messages.h"
#include "sim/study/result_recorder.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"
#include "sim/study/worker_threads.h"

/// One study on several processes: rank 0 reads and writes the store, hands out units one at a time
/// to whoever has a thread free, and computes too; the others compute, each thread with a unit at
/// hand to begin when it has finished one. Which rank computes a unit does not matter to its
/// result.
///
/// Rank r > 0          rank 0
///   Hello ->            all ranks are of the same study and instruction set, or it throws
///          <- Welcome   unless nothing is missing
///   Ready ->
///          <- Assigned  two for each of its threads, then one for each result; towards the end,
///                       one for each thread
///   Computed ->         stored
///          <- End       all is stored, or the study ended otherwise
namespace vernier::sim::internal {

/// Rank 0's part. It does not tell the others the end: end_ranks() does, whatever happened.
class RankZero {
 public:
  /// Keeps references to both.
  RankZero(Communicator& ranks, const StudyWork& work, std::stop_token stop);

  /// Waits until all ranks have said what they are about to do; returns the instruction sets of
  /// all. Throws Error if one has failed or works on another study, or if instruction sets differ
  /// and may not.
  std::string meet(OtherInstructionSets others);
  void welcome(bool has_blocks);
  /// Computes units on all ranks and on `own` threads, and records what they give. Returns when all
  /// are done or, asked to stop, when none runs any more or after 0.3 s: mpirun leaves no time for
  /// more. Throws the first error of any rank when none runs any more.
  void compute(std::vector<WorkUnit> units, WorkerThreads& own, ResultRecorder& recorder);

 private:
  struct Rank {
    std::string host;
    int threads = 0;  // 0: none that takes units
    int given = 0;    // units, not yet finished
  };
  struct Phase;

  std::string who(int rank) const;
  void take(const Message& message, Phase& phase);
  void take_own(WorkerThreads& own, Phase& phase, std::chrono::microseconds patience);
  void hand_out(Phase& phase, WorkerThreads& own);
  int all_threads(const WorkerThreads& own) const;
  void note_failure(std::exception_ptr failure);

  Communicator& ranks_;
  std::stop_token stop_;
  std::string fingerprint_;
  std::map<int, Rank> others_;
  std::int64_t next_number_ = 0;
  std::exception_ptr failure_;
};

/// Tells all ranks from 0 that no more is to be done; what cannot be sent is lost.
void end_ranks(Communicator& ranks) noexcept;

/// Another rank's part, until rank 0 tells the end. What fails here is told to rank 0, which throws
/// it. Asked to stop, it gives running units 0.3 s, leaves the others to rank 0, and waits for the
/// end too: mpirun kills all ranks as soon as one of them has ended.
void serve_study(const Study& study, int threads, Communicator& ranks, const std::stop_token& stop);

/// Tells rank 0 why this rank cannot take part, and waits for the end.
void tell_failure(const Failed& failure, Communicator& ranks);

}  // namespace vernier::sim::internal
