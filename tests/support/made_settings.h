// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "calib/statistics/random.h"
#include "sim/tuning/race.h"

namespace vernier::test {

/// Settings with known success rates, and their trials.
struct MadeSettings {
  std::vector<double> success;
  /// Standard deviation of a map's effect on the rate of one setting, and of all alike.
  double own_effect = 0, common_effect = 0;
  int trials_a_round = 50;
  std::uint64_t seed = 31;
};

/// `count` success rates from `low` in equal steps.
inline std::vector<double> steps_from(double low, double step, int count) {
  std::vector<double> success;
  for (int i = 0; i < count; ++i) success.push_back(low + step * i);
  return success;
}

/// The settings of one study in an order of its own, and the trials of any of its rounds: binomial,
/// independent between settings unless maps have a common effect. Drawn by study, setting (by the
/// place of its rate in MadeSettings) and round.
class MadeRace {
 public:
  MadeRace(const MadeSettings& made, std::uint32_t study) : made_(made), study_(study) {
    order_.resize(made.success.size());
    std::iota(order_.begin(), order_.end(), 0u);
    vernier::internal::RandomStream draws(
        {.seed = made.seed, .trial = study, .source = test_source});
    for (std::size_t i = order_.size(); i > 1; --i) {
      std::swap(order_[i - 1], order_[draws.below(static_cast<std::uint32_t>(i))]);
    }
  }

  double success(int candidate) const { return made_.success[setting(candidate)]; }
  double best() const { return *std::max_element(made_.success.begin(), made_.success.end()); }

  std::vector<double> round(int candidate, int number) const {
    const auto frame = static_cast<std::uint32_t>(number);
    const std::uint32_t which = setting(candidate);
    double rate = made_.success[which];
    if (made_.own_effect > 0 || made_.common_effect > 0) {
      vernier::internal::RandomStream own(place(1 + which, frame, 1)), common(place(0, frame, 1));
      rate += made_.own_effect * own.normal() + made_.common_effect * common.normal();
    }
    vernier::internal::RandomStream draws(place(1 + which, frame, 0));
    std::vector<double> scores(static_cast<std::size_t>(made_.trials_a_round));
    for (double& score : scores) score = draws.uniform() < rate ? 1 : 0;
    return scores;
  }

 private:
  static constexpr std::uint32_t test_source = 201;

  std::uint32_t setting(int candidate) const { return order_[static_cast<std::size_t>(candidate)]; }
  vernier::internal::RandomCounter place(std::uint32_t feature,
                                         std::uint32_t frame,
                                         int eye) const {
    return {.seed = made_.seed,
            .trial = study_,
            .feature = feature,
            .source = test_source,
            .eye = static_cast<std::uint32_t>(eye),
            .frame = frame};
  }

  const MadeSettings& made_;
  std::uint32_t study_;
  std::vector<std::uint32_t> order_;
};

/// What a race over made settings came to.
struct MadeResult {
  int winner = 0;
  std::int64_t rounds = 0;  ///< of all candidates together
  sim::internal::RaceState state;
  sim::internal::RaceScores scores;
};

/// Runs it to its end, computing the rounds it asks for.
inline MadeResult run_race(const MadeRace& race,
                           int candidates,
                           int rounds,
                           const sim::internal::RaceOptions& options) {
  MadeResult result;
  result.scores.resize(static_cast<std::size_t>(candidates));
  for (;;) {
    result.state = sim::internal::follow_race(result.scores, rounds, options);
    if (result.state.over) break;
    for (int i = 0; i < candidates; ++i) {
      auto& of = result.scores[static_cast<std::size_t>(i)];
      const auto& racer = result.state.racers[static_cast<std::size_t>(i)];
      while (static_cast<int>(of.size()) < racer.rounds) {
        of.push_back(race.round(i, static_cast<int>(of.size())));
      }
    }
  }
  result.winner = result.state.leader;
  for (const auto& of : result.scores) result.rounds += static_cast<std::int64_t>(of.size());
  return result;
}

/// The candidate with the best mean after all rounds of all of them.
inline int full_grid(const MadeRace& race, int candidates, int rounds) {
  int best = 0;
  double most = -1;
  for (int i = 0; i < candidates; ++i) {
    double sum = 0;
    for (int k = 0; k < rounds; ++k) {
      for (const double score : race.round(i, k)) sum += score;
    }
    if (sum > most) {
      most = sum;
      best = i;
    }
  }
  return best;
}

}  // namespace vernier::test
