// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/confirmation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

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

/// The recorded maps of a study: conditions of one world share them, block by block.
using MapKey = std::pair<std::string, std::uint32_t>;  // world, block

MapKey map_of(const CellResult& cell, const TrialResult& trial) {
  return {cell.cell.world, trial.trial / static_cast<std::uint32_t>(cell.trials_per_block)};
}

/// Scores of two candidates in one trial, over the conditions of its world, which share its query.
struct TrialScores {
  double a = 0, b = 0;
  int conditions = 0;
};

/// Rounds are maps.
struct ScoresOfMaps {
  PairedScores all;
  std::map<std::string, PairedScores> by_world;
};

ScoresOfMaps paired(const StudyResults& a, const StudyResults& b, Objective objective) {
  const auto same = [](const CellResult& x, const CellResult& y) {
    return x.trials.size() == y.trials.size() && x.trials_per_block == y.trials_per_block;
  };
  if (a.cells.size() != b.cells.size() ||
      !std::equal(a.cells.begin(), a.cells.end(), b.cells.begin(), same)) {
    throw Error("confirmation", "the candidates have not the same trials",
                "confirm both on the same worlds, seed and number of trials");
  }
  std::map<MapKey, std::map<std::uint32_t, TrialScores>> maps;
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    const CellResult &of_a = a.cells[i], &of_b = b.cells[i];
    for (std::size_t k = 0; k < of_a.trials.size(); ++k) {
      TrialScores& trial = maps[map_of(of_a, of_a.trials[k])][of_a.trials[k].trial];
      trial.a += score(objective, of_a.trials[k]);
      trial.b += score(objective, of_b.trials[k]);
      ++trial.conditions;
    }
  }
  ScoresOfMaps scores;
  for (const auto& [map, trials] : maps) {
    std::vector<double> of_a, of_b;
    for (const auto& [number, trial] : trials) {
      of_a.push_back(trial.a / trial.conditions);
      of_b.push_back(trial.b / trial.conditions);
    }
    scores.all.add_round(of_a, of_b);
    scores.by_world[map.first].add_round(of_a, of_b);
  }
  return scores;
}

/// A standard deviation with the degrees of freedom that it is known with.
struct Deviation {
  double sd, dof;
};

/// Of the mean difference in further maps of these worlds: the worlds are strata, whose variances
/// add up, with the degrees of freedom of Welch and Satterthwaite. With a single map of a world
/// that between all maps.
Deviation deviation_in_these_worlds(const ScoresOfMaps& scores) {
  double variance = 0, squares = 0;
  for (const auto& [world, maps] : scores.by_world) {
    if (maps.rounds() < 2) return {scores.all.sd(), scores.all.rounds() - 1.0};
    const double share = maps.trials() / scores.all.trials();
    const double of_world = share * share * maps.sd() * maps.sd();
    variance += of_world;
    squares += of_world * of_world / (maps.rounds() - 1);
  }
  return {std::sqrt(variance), variance * variance / squares};
}

}  // namespace

CandidateFigures figures_of(const StudyResults& results,
                            const std::vector<int>& cells,
                            Objective objective,
                            int blocks) {
  CandidateFigures figures;
  std::map<std::string, ClusterCount> worlds;
  std::map<MapKey, ClusterCount> maps;
  int successes = 0;
  for (const int number : cells) {
    const CellResult& cell = results.cells[static_cast<std::size_t>(number)];
    for (const TrialResult& trial : cell.trials) {
      const MapKey map = map_of(cell, trial);
      if (blocks >= 0 && static_cast<int>(map.second) >= blocks) continue;
      for (ClusterCount* count : {&maps[map], &worlds[cell.cell.world]}) {
        ++count->trials;
        count->successes += trial.success();
      }
      ++figures.trials;
      successes += trial.success();
      figures.score += score(objective, trial);
      figures.cpu_s += trial.cpu_ms / 1000;
    }
  }
  if (figures.trials == 0) return figures;
  figures.score /= figures.trials;
  figures.success = static_cast<double>(successes) / figures.trials;
  std::vector<ClusterCount> of_maps, of_worlds;
  for (const auto& [map, count] : maps) of_maps.push_back(count);
  for (const auto& [world, count] : worlds) of_worlds.push_back(count);
  figures.maps = static_cast<int>(of_maps.size());
  figures.worlds = static_cast<int>(of_worlds.size());
  figures.success_interval_95 = interval_over_worlds_95(of_worlds);
  figures.over_worlds = figures.success_interval_95.has_value();
  if (!figures.over_worlds) figures.success_interval_95 = clustered_interval_95(of_maps);
  return figures;
}

ConfirmedDifference confirmed_difference(const StudyResults& a,
                                         const StudyResults& b,
                                         Objective objective) {
  const ScoresOfMaps scores = paired(a, b, objective);
  ConfirmedDifference result;
  result.difference = scores.all.difference();
  if (scores.all.rounds() < fewest_maps) return result;
  const auto [sd, dof] = deviation_in_these_worlds(scores);
  const double t = student_quantile(0.975, dof);
  result.interval_95 = {result.difference - t * sd, result.difference + t * sd};
  result.p_value = 2 * student_survival(std::abs(result.difference) / sd, dof);
  return result;
}

}  // namespace vernier::sim::internal
