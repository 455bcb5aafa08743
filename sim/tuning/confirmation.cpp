// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/confirmation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <utility>

#include "calib/error.h"
#include "calib/interval.h"
#include "calib/statistics/distributions.h"
#include "sim/experiment.h"
#include "sim/study/study.h"
#include "sim/study/success_interval.h"
#include "sim/tuning/objective.h"
#include "sim/tuning/paired_scores.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Two cells trial by trial; each block of a cell, a map, is a round.
void add_cell(const CellResult& a, const CellResult& b, Objective objective, PairedScores& all) {
  struct MapScores {
    std::vector<double> a, b;
  };
  std::map<std::uint32_t, MapScores> maps;
  for (std::size_t i = 0; i < a.trials.size(); ++i) {
    MapScores& map = maps[a.trials[i].trial / static_cast<std::uint32_t>(a.trials_per_block)];
    map.a.push_back(score(objective, a.trials[i]));
    map.b.push_back(score(objective, b.trials[i]));
  }
  for (const auto& [block, map] : maps) all.add_round(map.a, map.b);
}

PairedScores paired(const StudyResults& a, const StudyResults& b, Objective objective) {
  const auto same = [](const CellResult& x, const CellResult& y) {
    return x.trials.size() == y.trials.size() && x.trials_per_block == y.trials_per_block;
  };
  if (a.cells.size() != b.cells.size() ||
      !std::equal(a.cells.begin(), a.cells.end(), b.cells.begin(), same)) {
    throw Error("confirmation", "the candidates have not the same trials",
                "confirm both on the same worlds, seed and number of trials");
  }
  PairedScores all;
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    add_cell(a.cells[i], b.cells[i], objective, all);
  }
  return all;
}

}  // namespace

CandidateFigures figures_of(const StudyResults& results,
                            const std::vector<int>& cells,
                            Objective objective,
                            int blocks) {
  CandidateFigures figures;
  std::map<std::string, ClusterCount> worlds;
  std::vector<ClusterCount> maps;
  int successes = 0;
  for (const int number : cells) {
    const CellResult& cell = results.cells[static_cast<std::size_t>(number)];
    std::map<std::uint32_t, ClusterCount> of_cell;
    for (const TrialResult& trial : cell.trials) {
      const std::uint32_t block = trial.trial / static_cast<std::uint32_t>(cell.trials_per_block);
      if (blocks >= 0 && static_cast<int>(block) >= blocks) continue;
      for (ClusterCount* count : {&of_cell[block], &worlds[cell.cell.world]}) {
        ++count->trials;
        count->successes += trial.success();
      }
      ++figures.trials;
      successes += trial.success();
      figures.score += score(objective, trial);
      figures.cpu_s += trial.cpu_ms / 1000;
    }
    for (const auto& [block, map] : of_cell) maps.push_back(map);
  }
  if (figures.trials == 0) return figures;
  figures.score /= figures.trials;
  figures.success = static_cast<double>(successes) / figures.trials;
  figures.maps = static_cast<int>(maps.size());
  std::vector<ClusterCount> of_worlds;
  for (const auto& [world, count] : worlds) of_worlds.push_back(count);
  figures.worlds = static_cast<int>(of_worlds.size());
  figures.success_interval_95 = interval_over_worlds_95(of_worlds);
  figures.over_worlds = figures.success_interval_95.has_value();
  if (!figures.over_worlds) figures.success_interval_95 = clustered_interval_95(maps);
  return figures;
}

ConfirmedDifference confirmed_difference(const StudyResults& a,
                                         const StudyResults& b,
                                         Objective objective) {
  const PairedScores all = paired(a, b, objective);
  ConfirmedDifference result;
  result.difference = all.difference();
  if (all.rounds() < fewest_maps) return result;
  const double dof = all.rounds() - 1, sd = all.sd();
  const double t = student_quantile(0.975, dof);
  result.interval_95 = {result.difference - t * sd, result.difference + t * sd};
  result.p_value = 2 * student_survival(std::abs(result.difference) / sd, dof);
  return result;
}

}  // namespace vernier::sim::internal
