// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// How often a race of `tune` finds a setting within 1 point of the best, and what it costs, beside
// a full grid on the same trials:
//
//     tune_race [RUNS] [SEED]
//
// over 30 settings whose success is 0.80 to 0.945 in steps of 0.5 points, with binomial noise of
// their own, for several numbers of trials a setting may have; then over other settings, with maps
// that differ. The last columns: how often the test dropped the best setting for one that is worse
// by more than a point; the mean of the limit to how much better another may be than the winner,
// and how often it held.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "sim/tuning/race.h"
#include "tests/support/made_settings.h"

namespace {

using namespace vernier;
using namespace vernier::sim::internal;

constexpr double point = 0.01 + 1e-9;

struct Tally {
  int race_hits = 0, grid_hits = 0, wrongly_dropped = 0, covered = 0;
  double limit = 0;
  std::int64_t rounds = 0, most = 0;
};

/// Whether the test, not the end of a stage, dropped the best setting.
bool dropped_best(const test::MadeRace& race, const RaceState& state) {
  for (int i = 0; i < static_cast<int>(state.racers.size()); ++i) {
    if (race.success(i) >= race.best() && state.racers[i].fate == Fate::worse) return true;
  }
  return false;
}

void row(const char* name, const test::MadeSettings& made, int trials, int runs) {
  const int candidates = static_cast<int>(made.success.size());
  const int rounds = trials / made.trials_a_round;
  Tally tally;
  for (int run = 0; run < runs; ++run) {
    const test::MadeRace race(made, static_cast<std::uint32_t>(run));
    const test::MadeResult result = test::run_race(race, candidates, rounds, {});
    const int grid = test::full_grid(race, candidates, rounds);
    const bool hit = race.success(result.winner) >= race.best() - point;
    tally.race_hits += hit;
    tally.grid_hits += race.success(grid) >= race.best() - point;
    tally.wrongly_dropped += !hit && dropped_best(race, result.state);
    const double limit = shortfall_limit(result.scores, result.winner, 0.05);
    tally.covered += race.best() - race.success(result.winner) <= limit;
    tally.limit += limit;
    tally.rounds += result.rounds;
    tally.most = std::max(tally.most, result.rounds);
  }
  const double grid = static_cast<double>(candidates) * rounds;
  const double mean = static_cast<double>(tally.rounds) / runs;
  std::printf("%-22s %6d   %5d of %d  %8.0f  %5.3f  %5.3f   %5d of %d  %8.0f   %d   %5.3f %d\n",
              name, trials, tally.race_hits, runs, mean * made.trials_a_round, mean / grid,
              static_cast<double>(tally.most) / grid, tally.grid_hits, runs,
              grid * made.trials_a_round, tally.wrongly_dropped, tally.limit / runs, tally.covered);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  if (runs < 1) {
    std::fprintf(stderr, "usage: tune_race [RUNS] [SEED]\n");
    return 2;
  }
  std::printf("%d runs a row, seed %llu; within 1 point of the best\n", runs,
              static_cast<unsigned long long>(seed));
  std::printf("%-22s %6s   %12s  %8s  %5s  %5s   %12s  %8s   %s\n", "settings", "trials", "race",
              "trials", "share", "most", "full grid", "trials", "dropped; limit, held");
  const test::MadeSettings bar{.success = test::steps_from(0.80, 0.005, 30), .seed = seed};
  for (const int trials : {600, 900, 1200, 1500, 2000, 3000, 5000}) {
    row("0.80 to 0.945", bar, trials, runs);
  }
  test::MadeSettings other{.success = test::steps_from(0.1, 0.027, 30), .seed = seed};
  row("0.10 to 0.883", other, 900, runs);
  row("0.10 to 0.883", other, 2000, runs);
  other.success = test::steps_from(0.80, 0.005, 30);
  other.own_effect = other.common_effect = 0.05;
  row("maps differ by 5 points", other, 2000, runs);
  other = {.success = test::steps_from(0.90, 0, 10), .seed = seed};
  other.success[3] = 0.95;
  row("one better by 5", other, 2000, runs);
  other.success = test::steps_from(0.70, 0.05, 5);
  row("5, 0.70 to 0.90", other, 900, runs);
  return 0;
}
