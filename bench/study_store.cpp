// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// What the store of a study costs: fills the folder of a study with results that were not computed,
// as so many shards, each block committed by itself as a run does it. Prints the time a block, the
// bytes a trial and the memory. `vernier study merge`, `status` and `export` can then be measured.
//
//   study_store FOLDER SHARDS     FOLDER holds study.toml, world.world.toml and rig.json
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bench/made_up_results.h"
#include "calib/base/atomic_file.h"
#include "calib/base/fingerprint.h"
#include "calib/error.h"
#include "calib/rig_file.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/world_file.h"

namespace fs = std::filesystem;
using namespace vernier;
using namespace vernier::internal;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

/// Of this process.
double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double max_memory_mb() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / 1024;
}

void fill(const fs::path& folder, const StudyWork& work, Shard shard, double& encoding_s) {
  StudyStore store(store_file(folder, shard));
  for (const CeilingJob& ceiling : work.ceilings) {
    QueryCeilings of_query(static_cast<std::size_t>(ceiling.queries));
    for (int i = shard.index; i < ceiling.queries; i += shard.count) {
      of_query[i] = QueryCeiling{1.0 / (1 + i % 3), i % 3 == 0};
    }
    const auto [key, value] = ceiling_part(ceiling.key, of_query);
    store.set_note(key, value);
  }
  for (std::size_t i = shard.index; i < work.blocks.size(); i += shard.count) {
    const std::vector<TrialResult> trials =
        made_up_trials(work.blocks[i].first, work.blocks[i].count);
    const double start = cpu_s();
    const BlockRow row =
        block_row(work.cell_keys[work.blocks[i].cell], work.blocks[i].block, trials);
    encoding_s += cpu_s() - start;
    store.put(row);
  }
}

void run(const fs::path& folder, int shards) {
  const Study study = made_up_study(folder);
  const StudyWork work = study_work(study);
  double encoding_s = 0;
  const double start = wall_s(), cpu_start = cpu_s();
  for (int i = 0; i < shards; ++i) fill(folder, work, {i, shards}, encoding_s);
  const double filled = wall_s() - start, filling_s = cpu_s() - cpu_start;
  std::uintmax_t bytes = 0;
  for (const fs::path& file : store_files(folder)) bytes += fs::file_size(file);
  const double blocks = static_cast<double>(work.blocks.size());
  const double trials = static_cast<double>(study.file.trials) * study.file.cells.size();
  fmt::print("{:.0f} trials in {:.0f} blocks, {} stores: {:.1f} bytes a trial\n", trials, blocks,
             shards, static_cast<double>(bytes) / trials);
  fmt::print(
      "a block: {:.1f} us of CPU to encode, {:.1f} us to make up, encode and commit, {:.1f} us "
      "of wall time\n",
      1e6 * encoding_s / blocks, 1e6 * filling_s / blocks, 1e6 * filled / blocks);
  fmt::print("memory to write: {:.1f} MB\n", max_memory_mb());
  const double read_start = wall_s(), read_cpu = cpu_s();
  std::size_t read = 0;
  const StudyResults results = visit_results(
      study, folder, [&](std::size_t, std::vector<TrialResult> some) { read += some.size(); });
  fmt::print(
      "read {} trials, {} of {} blocks: {:.2f} us of CPU a trial, {:.1f} s of wall time; "
      "memory {:.1f} MB\n",
      read, results.blocks_done, results.blocks_total, 1e6 * (cpu_s() - read_cpu) / trials,
      wall_s() - read_start, max_memory_mb());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: study_store FOLDER SHARDS\n");
    return 2;
  }
  try {
    run(argv[1], std::max(1, std::atoi(argv[2])));
  } catch (const Error& error) {
    fmt::print(stderr, "study_store: {}\n", error.what());
    return 2;
  }
}
