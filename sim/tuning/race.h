// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace vernier::sim::internal {

/// Scores in [0, 1], more is better: of each candidate, of each round from the first without a gap,
/// of the round's trials, which are the same for all candidates.
using RaceScores = std::vector<std::vector<std::vector<double>>>;

struct RaceOptions {
  /// Candidates that differ by less count as equally good.
  double indifference = 0.01;
  /// With which the test may drop the best candidate for one that is worse by more than that.
  double error_rate = 0.05;
};

/// A stage of a race: so many candidates at most, until each has so many rounds.
struct RaceStage {
  int candidates = 0, rounds = 0;
};

/// Halves the candidates from stage to stage, down to two, which run all rounds: successive halving
/// (Karnin, Koren and Somekh, ICML 2013). Of S stages, s ends after
///
///     rounds / 2^(S - s)
///
/// rounds, so that each costs about as much as the others, and all together about
/// rounds (1 + log2 candidates) in place of rounds × candidates. Where there are fewer rounds than
/// that halves, the first stage ends after one round with a larger cut.
std::vector<RaceStage> race_stages(int candidates, int rounds);

/// Candidates × rounds that the stages cost if no test drops one.
std::int64_t cost_of(const std::vector<RaceStage>& stages);

enum class Fate {
  racing,
  won,
  worse,   ///< dropped by the test: not better than the leader by more than the indifference
  behind,  ///< not among the better half when its stage ended; no certainty is claimed
};

std::string_view name(Fate fate);

struct Racer {
  Fate fate = Fate::racing;
  int rounds = 0;  ///< that it needs so far, or had when it was dropped
};

struct RaceState {
  std::vector<Racer> racers;
  int leader = 0;  ///< highest mean of those racing, the first of equals; the winner at the end
  bool over = false;
};

/// Follows a race as far as there are scores. Rounds are taken in their order, whoever computed
/// them, so that threads and interruptions decide nothing. After 4, 5, 7, 9, 12 … rounds (each a
/// quarter more) and at the end of a stage, a candidate is dropped if the limit of what it may be
/// better than the leader (paired_scores.h), with error_rate / (candidates - 1), is below the
/// indifference; at the end of a stage the worse half too. Any better candidate would have to be
/// dropped against a leader, one of candidates - 1, hence the error rate. Throws Error without
/// candidates or rounds, or for an option out of its range.
RaceState follow_race(const RaceScores& scores, int rounds, const RaceOptions& options);

/// How much better the best candidate may still be than the winner, at most, with a confidence of
/// 1 - error_rate: the largest of the limits of paired_scores.h, on the rounds that each candidate
/// shares with it. Most candidates have few rounds, so the design effect is that of all pairs
/// together, not below 1, with the degrees of freedom of the winner's rounds.
double shortfall_limit(const RaceScores& scores, int of, double error_rate);

/// The candidates from best to worst: the winner first, then by rounds, then by mean score.
std::vector<int> ranking(const RaceState& state, const RaceScores& scores);

/// Mean score of a candidate's first rounds; 0 without trials.
double mean_score(const std::vector<std::vector<double>>& rounds, int first);

}  // namespace vernier::sim::internal
