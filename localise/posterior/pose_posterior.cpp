// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/posterior/pose_posterior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include "localise/place.h"

namespace vernier::localise::internal {

double least_error_rate(std::size_t nodes, const PosteriorOptions& options) {
  const double unknown =
      std::min(static_cast<double>(nodes) * options.unknown, options.most_unknown);
  return unknown / (1 + unknown);
}

namespace {

constexpr double success_m = 1;

/// Weights of modes, best score first, of which the first has 1: a place has that of its best mode
/// by the evidence, the others of a place by their scores against that.
std::vector<double> weights_of(std::span<const WeightedMode> modes,
                               double share,
                               const PosteriorOptions& options,
                               const EvidenceBetween& evidence_between) {
  std::vector<double> weights;
  for (const WeightedMode& mode : modes) {
    const auto leader = std::find_if(modes.begin(), modes.end(), [&](const WeightedMode& m) {
      return distance_m(m.best.pose, mode.best.pose) <= success_m;
    });
    const auto known = static_cast<std::size_t>(leader - modes.begin());
    const bool by_evidence = evidence_between && known > 0;
    const Hypothesis& reference = by_evidence ? leader->best : modes[0].best;
    double weight = std::exp(share * (mode.best.score - reference.score));
    if (by_evidence) {
      weight *= known < weights.size()
                    ? weights[known]
                    : weight_against(evidence_between(modes[0].best, mode.best), share, options);
    }
    weights.push_back(weight);
  }
  return weights;
}

/// Logarithm of the density of a difference of scores, per nat, where places are equal.
double log_density_if_equal(double nats, double variance) {
  return -0.5 * nats * nats / variance - 0.5 * std::log(2 * std::numbers::pi * variance);
}

}  // namespace

RecordedDifference of_both(const RecordedDifference& a, const RecordedDifference& b) {
  RecordedDifference sum;
  const int fewer = std::min(a.views, b.views);
  if (fewer == 0) return sum;
  for (const RecordedDifference* of : {&a, &b}) {
    const double share = static_cast<double>(fewer) / of->views;
    sum.nats += share * of->nats;
    sum.variance += share * of->variance;
    sum.views += fewer;
  }
  return sum;
}

double probability_equal(double before,
                         const RecordedDifference& recorded,
                         const PosteriorOptions& options) {
  const double views = recorded.views;
  if (!(before > 0 && recorded.variance >= views * options.least_recorded && views > 0)) {
    return before;
  }
  const double variance =
      options.dependence * (1 + (views - 1) * options.of_one_place) * recorded.variance;
  const double log_equal = log_density_if_equal(recorded.nats, variance);
  const double log_differ = std::log(options.differing_per_nat / views) +
                            options.evidence_share * std::min(recorded.nats, 0.0);
  const double log_odds = std::log(before / (1 - before)) + log_equal - log_differ;
  return 1 / (1 + std::exp(-log_odds));
}

double weight_against(const Evidence& evidence, double share, const PosteriorOptions& options) {
  const double certain = std::exp(-share * evidence.certain);
  const double variance = options.dependence * evidence.variance;
  if (!(variance > 0)) return certain;
  const double d = evidence.doubtful;
  const double equal = evidence.repeated * std::exp(log_density_if_equal(d, variance));
  const double differ = (1 - evidence.repeated) * options.differing_per_nat;
  return certain * (equal + differ * std::exp(-share * std::max(d, 0.0))) /
         (equal + differ * std::exp(share * std::min(d, 0.0)));
}

std::vector<WeightedMode> pose_posterior(std::span<const Hypothesis> hypotheses,
                                         const ViewSize& view,
                                         std::size_t nodes,
                                         const PosteriorOptions& options,
                                         const EvidenceBetween& evidence_between) {
  constexpr std::size_t most_modes = 20;
  constexpr double same_m = 0.3, same_rad = 0.2;
  std::vector<Hypothesis> sorted(hypotheses.begin(), hypotheses.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; });
  std::vector<WeightedMode> modes;
  for (const Hypothesis& h : sorted) {
    const bool known = std::any_of(modes.begin(), modes.end(), [&](const WeightedMode& m) {
      return is_close_to(m.best.pose, h.pose, same_m, same_rad);
    });
    if (!known && modes.size() < most_modes) modes.push_back({h, 0});
  }
  if (modes.empty()) return modes;
  const double best = modes[0].best.score;
  const double misfit = std::max(0.0, -best / std::max(1.0, view.observations));
  const double share = options.evidence_share / std::max(1.0, misfit / options.usual_misfit);
  const double seen = std::max(0.0, view.observations);
  const auto size = static_cast<double>(nodes);
  const double root = std::sqrt(seen / options.usual_observations);
  const double lost = std::pow(std::clamp(size / options.usual_nodes, 1.0, options.most_times), 2) *
                      std::exp(options.steepness * (misfit - options.lost_misfit) * root);
  const double thin = options.thin * std::exp(-seen / options.thin_observations);
  const double few =
      std::pow(options.told_by_a_line, options.few_lines - static_cast<double>(view.lines));
  double total = lost + size * thin + std::min(size * options.unknown, options.most_unknown) + few;
  std::vector<double> weights = weights_of(modes, share, options, evidence_between);
  for (double& weight : weights) weight = std::pow(weight, options.tempering);
  total = std::accumulate(weights.begin(), weights.end(), total);
  if (options.off_map > 0) {
    const double gain =
        options.off_gain + options.off_steepness * (misfit - options.off_misfit) * root;
    total *= 1 + options.off_map / (1 - options.off_map) * std::exp(gain);
  }
  for (WeightedMode& m : modes) {
    for (std::size_t i = 0; i < modes.size(); ++i) {
      if (distance_m(modes[i].best.pose, m.best.pose) <= success_m)
        m.probability += weights[i] / total;
    }
  }
  std::stable_sort(modes.begin(), modes.end(), [](const WeightedMode& a, const WeightedMode& b) {
    return a.probability > b.probability;
  });
  return modes;
}

}  // namespace vernier::localise::internal
