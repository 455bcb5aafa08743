// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/random.h"

namespace vernier {

/// How the success rates of maps differ.
enum class MapKind {
  beta,        ///< beta-distributed: trials are those of Pólya's urn
  logistic,    ///< logit normal
  some_worse,  ///< one map in eight is worse than the others, which are alike
};

/// Studies with a known success rate: maps that differ, with a correlation between the trials of a
/// map, drawn by the number of the study, so that one with fewer maps is the start of one with
/// more.
struct MadeMaps {
  MapKind kind = MapKind::beta;
  double success = 0.9;
  double correlation = 0.05;  ///< ρ: the maps' rates have the variance ρ p (1 - p)
  int trials_a_map = 50;
  std::uint64_t seed = 20;
};

namespace made_maps_detail {

inline constexpr std::uint32_t test_source = 200;

/// Mean and variance of the rate of logit-normal maps, by the midpoint rule over its quantiles.
inline void logistic_moments(double centre, double spread, double& mean, double& variance) {
  constexpr int steps = 400;
  mean = variance = 0;
  for (int i = 0; i < steps; ++i) {
    const double z = vernier::internal::normal_quantile((i + 0.5) / steps);
    const double rate = 1 / (1 + std::exp(-(centre + spread * z)));
    mean += rate / steps;
    variance += rate * rate / steps;
  }
  variance -= mean * mean;
}

/// Centre and spread of the logit-normal maps with the wanted mean and variance, by bisection.
inline void fit_logistic(const MadeMaps& made, double& centre, double& spread) {
  double mean = 0, variance = 0;
  const auto centre_at = [&](double with) {
    double low = -60, high = 60;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      logistic_moments(middle, with, mean, variance);
      (mean < made.success ? low : high) = middle;
    }
    return 0.5 * (low + high);
  };
  const double wanted = made.correlation * made.success * (1 - made.success);
  double low = 0, high = 12;
  for (int i = 0; i < 40; ++i) {
    spread = 0.5 * (low + high);
    centre = centre_at(spread);
    (variance < wanted ? low : high) = spread;
  }
}

}  // namespace made_maps_detail

/// Draws such studies: maps(study, K).
class MapMaker {
 public:
  explicit MapMaker(const MadeMaps& made) : made_(made) {
    const double p = made.success;
    if (made.kind == MapKind::logistic && made.correlation > 0) {
      made_maps_detail::fit_logistic(made, centre_, spread_);
    } else if (made.kind == MapKind::some_worse) {
      const double apart =
          std::sqrt(made.correlation * p * (1 - p) / (worse_share * (1 - worse_share)));
      better_ = p + worse_share * apart;  // may exceed 1: no such maps, cut to what there is
      if (better_ > 1) better_ = 1;
      worse_ = (p - (1 - worse_share) * better_) / worse_share;
    }
  }

  std::vector<ClusterCount> maps(std::uint32_t study, int count) const {
    std::vector<ClusterCount> counts;
    for (int map = 0; map < count; ++map) {
      vernier::internal::RandomStream draws({.seed = made_.seed,
                                             .trial = study,
                                             .feature = static_cast<std::uint32_t>(map),
                                             .source = made_maps_detail::test_source});
      counts.push_back(one(draws));
    }
    return counts;
  }

 private:
  static constexpr double worse_share = 0.125;

  ClusterCount one(vernier::internal::RandomStream& draws) const {
    ClusterCount count;
    const double p = made_.success, rho = made_.correlation;
    const bool urn = made_.kind == MapKind::beta && rho > 0;
    const double size = urn ? (1 - rho) / rho : 0;
    double rate = p;
    if (made_.kind == MapKind::logistic && rho > 0) {
      rate = 1 / (1 + std::exp(-(centre_ + spread_ * draws.normal())));
    } else if (made_.kind == MapKind::some_worse) {
      rate = draws.uniform() < worse_share ? worse_ : better_;
    }
    for (; count.trials < made_.trials_a_map; ++count.trials) {
      if (urn) rate = (size * p + count.successes) / (size + count.trials);
      count.successes += draws.uniform() < rate;
    }
    return count;
  }

  MadeMaps made_;
  double centre_ = 0, spread_ = 0;  // of logit-normal maps
  double better_ = 1, worse_ = 0;
};

}  // namespace vernier
