// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// How many blocks rank 0 can hand out and store: ranks that answer at once with trials that were
// not computed, several units at a time each, as ranks with so many threads. Rank 0 computes
// nothing.
//
//   mpirun -n 3 rank_hand_out FOLDER [UNITS AT A TIME]
//   FOLDER holds study.toml, world.world.toml and rig.json; results go to FOLDER/hand_out
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "bench/made_up_results.h"
#include "calib/base/instruction_set.h"
#include "calib/error.h"
#include "sim/mpi/mpi_ranks.h"
#include "sim/study/rank_messages.h"
#include "sim/study/result_recorder.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_ranks.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"
#include "sim/study/worker_threads.h"

using namespace vernier;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

/// Answers every unit at once; like all ranks it sleeps at most a millisecond without news.
void answer(const Study& study, const StudyWork& work, int at_a_time, Communicator& ranks) {
  ranks.send(0, rank_text(Hello{work_fingerprint(work),
                                std::string(vernier::internal::instruction_set()), "bench"}));
  std::vector<TrialResult> trials = made_up_trials(0, study.file.trials_per_block);
  for (;;) {
    const auto message = ranks.receive();
    if (!message) continue;
    const RankMessage said = parse_rank_text(message->text);
    if (std::holds_alternative<End>(said)) return;
    if (std::holds_alternative<Welcome>(said)) ranks.send(0, rank_text(Ready{at_a_time}));
    if (const auto* given = std::get_if<Assigned>(&said)) {
      const BlockJob& job = work.blocks[given->unit.block];
      for (int i = 0; i < job.count; ++i) trials[i].trial = job.first + i;
      UnitResult result{block_row(work.cell_keys[job.cell], job.block, trials), {}};
      ranks.send(0, rank_text(Computed{given->number, std::move(result)}));
    }
  }
}

void hand_out(const Study& study,
              const StudyWork& work,
              const std::filesystem::path& folder,
              Communicator& ranks) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  StudyStore store(store_file(folder, {}));
  const StudyRun run{.folder = folder};
  RankZero zero(ranks, work, {});
  zero.meet(OtherInstructionSets::refused);
  const MissingWork missing = missing_work(study, work, {}, StoredResults());
  ResultRecorder recorder(work, missing, run, store);
  const UnitComputer computer(study, work);
  WorkerThreads none(computer, 0, {});
  zero.welcome(true);
  const auto cpu = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start = cpu();
  zero.compute(block_units(missing), none, recorder);
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double blocks = static_cast<double>(work.blocks.size());
  fmt::print(
      "{:.0f} blocks of {} trials on {} ranks: {:.1f} us a block, {:.1f} us of CPU on rank 0\n",
      blocks, study.file.trials_per_block, ranks.size() - 1, 1e6 * s / blocks,
      1e6 * (cpu() - cpu_start) / blocks);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: mpirun -n N rank_hand_out FOLDER [UNITS AT A TIME]\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    const Study study = made_up_study(folder);
    const StudyWork work = study_work(study);
    const auto ranks = mpi_ranks();
    if (ranks->rank() > 0) {
      answer(study, work, argc > 2 ? std::atoi(argv[2]) : 1, *ranks);
    } else {
      hand_out(study, work, folder / "hand_out", *ranks);
      end_ranks(*ranks);
    }
  } catch (const Error& error) {
    fmt::print(stderr, "rank_hand_out: {}\n", error.what());
    return 2;
  }
}
