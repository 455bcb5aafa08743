// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "localise/place.h"

namespace vernier::localise::internal {

/// A pose that was compared with the view.
struct Hypothesis {
  Pose2D pose;
  int node = -1;
  double score = 0;  ///< log-likelihood, nats
};

/// How scores become probabilities. The likelihood model counts evidence that is not independent,
/// and the true pose may not be among the hypotheses; all three numbers are fitted on worlds that
/// judge nothing.
struct PosteriorOptions {
  double evidence_share = 0.17;  ///< of a difference of scores that counts
  /// A pose that was not tried scores this much below 0 and for each observation of the view.
  double elsewhere_nats = 10, elsewhere_nats_per_observation = 1.3;
};

/// A mode: the probability is that of a pose within 1 m, not of this pose alone.
struct WeightedMode {
  Hypothesis best;
  double probability = 0;
};

/// Modes of a view of so many observations, further than 0.3 m or 0.2 rad apart: the 20 of best
/// score, most probable first.
std::vector<WeightedMode> pose_posterior(std::span<const Hypothesis> hypotheses,
                                         double observations,
                                         const PosteriorOptions& options = {});

}  // namespace vernier::localise::internal
