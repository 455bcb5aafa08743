// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/race.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <tuple>

#include "calib/error.h"
#include "sim/tuning/paired_scores.h"

namespace vernier::sim::internal {

namespace {

constexpr int first_look = 4;  ///< rounds

int next_look(int rounds) { return rounds < first_look ? first_look : (5 * rounds + 3) / 4; }

void check(std::size_t candidates, int rounds, const RaceOptions& options) {
  const auto refuse = [](const std::string& fault, const char* remedy) {
    throw Error("race", fault, remedy);
  };
  if (candidates == 0 || rounds < 1) refuse("has no candidates or no rounds", "give some");
  if (!(options.indifference >= 0 && options.indifference < 1)) {
    refuse(fmt::format("an indifference of {}", options.indifference), "use one in [0, 1)");
  }
  if (!(options.error_rate > 0 && options.error_rate < 0.5)) {
    refuse(fmt::format("an error rate of {}", options.error_rate), "use one in (0, 0.5)");
  }
}

/// By how much `a` is better than `b` in the first rounds.
PairedScores paired(const RaceScores& scores, int a, int b, int rounds) {
  PairedScores pair;
  const auto &of_a = scores[static_cast<std::size_t>(a)],
             &of_b = scores[static_cast<std::size_t>(b)];
  for (std::size_t k = 0; k < static_cast<std::size_t>(rounds); ++k) {
    pair.add_round(of_a[k], of_b[k]);
  }
  return pair;
}

/// A share of the error rate for each of those that one can be compared with.
double error_rate_of_one(double error_rate, std::size_t candidates) {
  return error_rate / static_cast<double>(std::max<std::size_t>(1, candidates - 1));
}

/// A race while it is followed.
class Follower {
 public:
  Follower(const RaceScores& scores, int rounds, const RaceOptions& options)
      : scores_(scores),
        options_(options),
        rounds_(rounds),
        stages_(race_stages(static_cast<int>(scores.size()), rounds)),
        racing_(scores.size()) {
    state_.racers.resize(scores.size());
    std::iota(racing_.begin(), racing_.end(), 0);
  }

  RaceState follow() {
    while (racing_.size() > 1) {
      const int next = std::min(next_look(done_), stages_[stage_].rounds);
      for (const int i : racing_) racer(i).rounds = next;
      const bool complete = std::all_of(racing_.begin(), racing_.end(), [&](int i) {
        return static_cast<int>(scores_[static_cast<std::size_t>(i)].size()) >= next;
      });
      if (!complete) return state_;
      done_ = next;
      rank();
      drop_worse();
      if (done_ == stages_[stage_].rounds) end_stage();
    }
    racer(racing_[0]).fate = Fate::won;
    state_.leader = racing_[0];
    state_.over = true;
    return state_;
  }

 private:
  Racer& racer(int i) { return state_.racers[static_cast<std::size_t>(i)]; }

  /// Sorts those racing, the best first.
  void rank() {
    std::vector<double> mean(scores_.size());
    for (const int i : racing_) {
      mean[static_cast<std::size_t>(i)] = mean_score(scores_[static_cast<std::size_t>(i)], done_);
    }
    std::sort(racing_.begin(), racing_.end(), [&](int a, int b) {
      const double of_a = mean[static_cast<std::size_t>(a)];
      const double of_b = mean[static_cast<std::size_t>(b)];
      return of_a != of_b ? of_a > of_b : a < b;
    });
    state_.leader = racing_[0];
  }

  void drop_worse() {
    if (done_ < first_look) return;
    const double alpha = error_rate_of_one(options_.error_rate, scores_.size());
    const int leader = state_.leader;
    std::erase_if(racing_, [&](int i) {
      if (i == leader) return false;
      if (paired(scores_, i, leader, done_).upper_limit(alpha) >= options_.indifference) {
        return false;
      }
      racer(i).fate = Fate::worse;
      return true;
    });
  }

  void end_stage() {
    const bool is_last = done_ == rounds_;
    if (!is_last) ++stage_;
    const auto keep = static_cast<std::size_t>(is_last ? 1 : stages_[stage_].candidates);
    while (racing_.size() > keep) {
      racer(racing_.back()).fate = Fate::behind;
      racing_.pop_back();
    }
  }

  const RaceScores& scores_;
  const RaceOptions& options_;
  int rounds_;
  std::vector<RaceStage> stages_;
  std::vector<int> racing_;
  RaceState state_;
  std::size_t stage_ = 0;
  int done_ = 0;
};

}  // namespace

std::string_view name(Fate fate) {
  switch (fate) {
    case Fate::won:
      return "won";
    case Fate::worse:
      return "worse";
    case Fate::behind:
      return "behind";
    case Fate::racing:
      break;
  }
  return "racing";
}

std::vector<RaceStage> race_stages(int candidates, int rounds) {
  std::vector<RaceStage> stages;
  for (int left = candidates; left > 1; left = (left + 1) / 2) stages.push_back({left, rounds});
  if (stages.empty()) return {{candidates, rounds}};
  double wanted = rounds;
  for (std::size_t s = stages.size() - 1; s-- > 0;) {
    wanted /= 2;
    stages[s].rounds = std::min(static_cast<int>(std::lround(wanted)), stages[s + 1].rounds - 1);
  }
  std::erase_if(stages, [](const RaceStage& stage) { return stage.rounds < 1; });
  stages.front().candidates = candidates;
  return stages;
}

std::int64_t cost_of(const std::vector<RaceStage>& stages) {
  std::int64_t cost = 0;
  int before = 0;
  for (const RaceStage& stage : stages) {
    cost += static_cast<std::int64_t>(stage.candidates) * (stage.rounds - before);
    before = stage.rounds;
  }
  return cost;
}

RaceState follow_race(const RaceScores& scores, int rounds, const RaceOptions& options) {
  check(scores.size(), rounds, options);
  return Follower(scores, rounds, options).follow();
}

double shortfall_limit(const RaceScores& scores, int of, double error_rate) {
  const double alpha = error_rate_of_one(error_rate, scores.size());
  const std::size_t rounds = scores[static_cast<std::size_t>(of)].size();
  std::vector<PairedScores> pairs;
  double between = 0, independent = 0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (static_cast<int>(i) == of) continue;
    const std::size_t shared = std::min(scores[i].size(), rounds);
    pairs.push_back(paired(scores, static_cast<int>(i), of, static_cast<int>(shared)));
    between += pairs.back().variances().between;
    independent += pairs.back().variances().independent;
  }
  const double effect = independent > 0 ? std::max(1.0, between / independent) : 1;
  double most = 0;
  for (const PairedScores& pair : pairs) {
    most = std::max(most, pair.upper_limit(alpha, effect, static_cast<int>(rounds) - 1));
  }
  return most;
}

std::vector<int> ranking(const RaceState& state, const RaceScores& scores) {
  std::vector<int> order(scores.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const Racer& racer = state.racers[static_cast<std::size_t>(i)];
    return std::tuple(racer.fate == Fate::won ? 0 : 1, -racer.rounds,
                      -mean_score(scores[static_cast<std::size_t>(i)], racer.rounds), i);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

double mean_score(const std::vector<std::vector<double>>& rounds, int first) {
  double sum = 0;
  std::size_t trials = 0;
  const std::size_t count = std::min(rounds.size(), static_cast<std::size_t>(first));
  for (std::size_t k = 0; k < count; ++k) {
    sum = std::accumulate(rounds[k].begin(), rounds[k].end(), sum);
    trials += rounds[k].size();
  }
  return trials > 0 ? sum / static_cast<double>(trials) : 0;
}

}  // namespace vernier::sim::internal
