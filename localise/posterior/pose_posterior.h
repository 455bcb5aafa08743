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
/// and the true pose may not be among the hypotheses; both are fitted on worlds that judge nothing.
struct PosteriorOptions {
  double evidence_share = 0.5;  ///< of a difference of scores that counts
  double elsewhere_nats = 4;    ///< score of a pose that was not tried, below that of the best
};

/// A mode: the probability is that of a pose within 1 m, not of this pose alone.
struct WeightedMode {
  Hypothesis best;
  double probability = 0;
};

/// Modes further than 0.3 m or 0.2 rad apart, best score first, at most 20.
std::vector<WeightedMode> pose_posterior(std::span<const Hypothesis> hypotheses,
                                         const PosteriorOptions& options = {});

}  // namespace vernier::localise::internal
