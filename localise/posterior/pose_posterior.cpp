// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/posterior/pose_posterior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "localise/place.h"

namespace vernier::localise::internal {

double least_error_rate(std::size_t nodes, const PosteriorOptions& options) {
  const double unknown =
      std::min(static_cast<double>(nodes) * options.unknown, options.most_unknown);
  return unknown / (1 + unknown);
}

std::vector<WeightedMode> pose_posterior(std::span<const Hypothesis> hypotheses,
                                         double observations,
                                         std::size_t nodes,
                                         const PosteriorOptions& options,
                                         const EvidenceBetween& evidence_between) {
  constexpr std::size_t most_modes = 20;
  constexpr double same_m = 0.3, same_rad = 0.2, success_m = 1;
  std::vector<Hypothesis> sorted(hypotheses.begin(), hypotheses.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; });
  std::vector<WeightedMode> modes;
  for (const Hypothesis& h : sorted) {
    const bool known = std::any_of(modes.begin(), modes.end(), [&](const WeightedMode& m) {
      return distance_m(m.best.pose, h.pose) < same_m &&
             std::abs(heading_difference_rad(m.best.pose, h.pose)) < same_rad;
    });
    if (!known && modes.size() < most_modes) modes.push_back({h, 0});
  }
  if (modes.empty()) return modes;
  std::vector<double> weights;
  const double best = modes[0].best.score;
  const double misfit = std::max(0.0, -best / std::max(1.0, observations));
  const double share = options.evidence_share / std::max(1.0, misfit / options.usual_misfit);
  const double seen = std::max(0.0, observations);
  const auto size = static_cast<double>(nodes);
  const double root = std::sqrt(seen / options.usual_observations);
  const double lost = std::pow(std::clamp(size / options.usual_nodes, 1.0, options.most_times), 2) *
                      std::exp(options.steepness * (misfit - options.lost_misfit) * root);
  const double thin = options.thin * std::exp(-seen / options.thin_observations);
  double total = lost + size * thin + std::min(size * options.unknown, options.most_unknown);
  for (const WeightedMode& m : modes) {
    const bool elsewhere = distance_m(m.best.pose, modes[0].best.pose) > success_m;
    const double behind = evidence_between && elsewhere ? evidence_between(modes[0].best, m.best)
                                                        : best - m.best.score;
    weights.push_back(std::exp(-share * behind));
    total += weights.back();
  }
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
