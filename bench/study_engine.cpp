// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// What a trial costs beside itself: the CPU time of a study on one thread, without its world
// ceiling, against that of its blocks run by hand, which store nothing. Alternately, a few times.
//
//   study_engine FOLDER [REPETITIONS]     FOLDER holds study.toml (without a sweep),
//   world.world.toml and rig.json
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/made_up_results.h"
#include "calib/error.h"
#include "sim/study/ceiling.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"

using namespace vernier;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A store with all of the ceilings, so that the study computes blocks only.
void store_ceilings(const StudyWork& work, const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  StudyStore store(store_file(folder, {}));
  for (const CeilingJob& ceiling : work.ceilings) {
    const auto [key, value] = ceiling_part(
        ceiling.key,
        QueryCeilings(static_cast<std::size_t>(ceiling.queries), QueryCeiling{1, true}));
    store.set_note(key, value);
  }
}

double by_hand(const Study& study, const StudyWork& work) {
  const double start = cpu_s();
  const Visibility visibility(study.world, study.file.cells[0].visibility);
  const ExperimentSettings& settings = study.file.cells[0].experiment;  // the only cell
  const auto views = std::make_shared<MapViews>(map_views(visibility, study.rig.rig, settings));
  const auto places =
      std::make_shared<QueryPlaces>(visibility, settings.protocol, settings.mount.height_m);
  for (const BlockJob& job : work.blocks) {
    const LocalisationExperiment experiment(visibility, study.rig, views, settings, places);
    experiment.run_block({.block = static_cast<std::uint32_t>(job.block),
                          .first = static_cast<std::uint32_t>(job.first),
                          .count = static_cast<std::uint32_t>(job.count)});
  }
  return cpu_s() - start;
}

double as_study(const Study& study, const StudyWork& work, const std::filesystem::path& folder) {
  store_ceilings(work, folder);
  const double start = cpu_s();
  run_study(study, {.folder = folder, .threads = 1});
  std::size_t read = 0;
  visit_results(study, folder,
                [&](std::size_t, std::vector<TrialResult> trials) { read += trials.size(); });
  return cpu_s() - start;
}

void run(const std::filesystem::path& folder, int repetitions) {
  const Study study = made_up_study(folder);
  const StudyWork work = study_work(study);
  const double trials = static_cast<double>(study.file.trials * study.file.cells.size());
  std::vector<double> excess, alone;
  for (int i = 0; i < repetitions; ++i) {
    double whole = 0;
    for (const int turn : {i % 2, 1 - i % 2}) {  // in turn first: the machine may get slower
      if (turn == 0) alone.push_back(1e6 * by_hand(study, work) / trials);
      if (turn == 1) whole = 1e6 * as_study(study, work, folder / "engine") / trials;
    }
    excess.push_back(whole - alone.back());
    fmt::print("by hand {:.0f} us a trial, as a study {:.0f} us: {:+.2f} %\n", alone.back(), whole,
               100 * excess.back() / alone.back());
  }
  const auto median = [](std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + v.size() / 2, v.end());
    return v[v.size() / 2];
  };
  fmt::print("median {:+.1f} us a trial of {:.0f} us: {:+.2f} %\n", median(excess), median(alone),
             100 * median(excess) / median(alone));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: study_engine FOLDER [REPETITIONS]\n");
    return 2;
  }
  try {
    run(argv[1], argc > 2 ? std::atoi(argv[2]) : 5);
  } catch (const Error& error) {
    fmt::print(stderr, "study_engine: {}\n", error.what());
    return 2;
  }
}
