// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "localise/place.h"

namespace vernier::localise::internal {

/// A pose that was compared with the view.
struct Hypothesis {
  Pose2D pose;
  int node = -1;
  double score = 0;                                       ///< log-likelihood, nats
  Eigen::Matrix3f information = Eigen::Matrix3f::Zero();  ///< of (x, y, turn) there, robot frame
};

/// What tells a hypothesis from another: nats by which its score is better.
struct Evidence {
  double certain = 0;   ///< whatever the places are
  double doubtful = 0;  ///< by lines that were recorded at each place anew
  double variance = 0;  ///< of the latter if the two places are equal: 0 on average
  double repeated = 0;  ///< probability that they are, by the map alone
};

/// What tells places apart in views that a map recorded: the sum of their doubtful differences,
/// each in favour of where the view was taken.
struct RecordedDifference {
  double nats = 0, variance = 0;  ///< variance: of one that is 0 on average, views independent
  int views = 0;
};

/// What the views of two places say together, as if both had as many as the one that has fewer: a
/// place that was recorded more often explains every view better. Nothing if one has no views.
RecordedDifference of_both(const RecordedDifference& a, const RecordedDifference& b);
using EvidenceBetween = std::function<Evidence(const Hypothesis&, const Hypothesis&)>;

/// How scores become probabilities. The likelihood model counts evidence that is not independent,
/// and the true pose may not be among the hypotheses. With the misfit q, the nats per observation
/// that the best score lies below 0, a difference of scores counts by
///
///     evidence_share / max(1, q / usual_misfit),
///
/// as standard errors are scaled by residuals (Birge, Physical Review 40, 1932), and the poses that
/// were not tried weigh, times the best one,
///
///     clamp(nodes / usual_nodes, 1, most_times)²
///         exp(steepness (q - lost_misfit) √(observations / usual_observations))
///       + nodes thin exp(-observations / thin_observations) + min(nodes unknown, most_unknown)
///       + told_by_a_line^(few_lines - lines)
///
/// since a misfit says that the map does not explain the view, few lines fit in many places, and
/// the larger a map, the more places are like another, and the more seldom the true one is tried
/// (measured to 28,504 nodes). Where a view shows next to nothing, what it does not show is all
/// that tells places apart, and edges are not lost independently: the last term, chosen on a bare
/// corridor of 30 x 2 m. All else is chosen on generated offices of seeds 1 to 20, which
/// judge nothing: maps of about 180 nodes along the route and 1400 all around, and those of all
/// offices together.
struct PosteriorOptions {
  double evidence_share = 0.55;
  /// A mode that weighs w against the best one, by all of the above, counts w^tempering: what a
  /// model that is not quite true says is tempered (Grünwald and van Ommen, Bayesian Analysis 12,
  /// 2017). By maximum likelihood on the offices (0.65 to 0.7 along the route, near it with one
  /// look and with two, and anywhere): untempered, of what states 0.1 to 5 % two to ten times as
  /// much was wrong.
  double tempering = 0.7;
  double usual_misfit = 0.4, lost_misfit = 2.3, steepness = 8;
  double thin = 3e-5, thin_observations = 12;    ///< thin: of a node
  double few_lines = 4, told_by_a_line = 4;      ///< a view of four lines is half believed
  double unknown = 2.1e-7, most_unknown = 5e-4;  ///< of a node: what the model does not know
  double usual_observations = 60;                ///< of a view of a third as many lines as usual
  /// Those of a map along the route, and how many times as many still count.
  double usual_nodes = 180, most_times = 160;
  /// Of places that may be equal: how many times as large as by independent lines the variance is,
  /// and the density of a difference of scores, per nat, where places differ.
  double dependence = 1.5, differing_per_nat = 0.01;
  /// Correlation of the differences of two views of one place, which are compared with the same
  /// recordings of the other.
  double of_one_place = 0.15;
  /// Recorded views that have less to compare, nats² a view, say nothing: a line or two.
  double least_recorded = 4;
  /// Prior probability that the view was taken where the map holds nothing. Its odds grow by
  ///
  ///     exp(off_gain + off_steepness (q - off_misfit) √(observations / usual_observations)),
  ///
  /// a logistic regression on the best scores of views within 0.8 m of the nearest node and beyond
  /// 1.5 m, maps of whole and half offices of seeds 1 to 20 along the route (89 and 178 nodes).
  double off_map = 0;
  double off_gain = 4.3, off_steepness = 2.9, off_misfit = 2.3;
};

/// The smallest error rate that can be stated in a map of so many nodes: the rest is what the model
/// does not know.
double least_error_rate(std::size_t nodes, const PosteriorOptions& options = {});

/// Probability that two places are equal which was `before`, by what the views recorded at them say
/// (docs/localisation.md, equation 1).
double probability_equal(double before,
                         const RecordedDifference& recorded,
                         const PosteriorOptions& options = {});

/// Weight of the other hypothesis where that with this evidence weighs 1, with the share by which
/// evidence counts (docs/localisation.md, "Places that are alike").
double weight_against(const Evidence& evidence, double share, const PosteriorOptions& options = {});

/// How much a view shows, in all its looks: lines, and what they count
/// (verification/view_agreement.h).
struct ViewSize {
  double observations = 0;
  std::size_t lines = 0;
};

/// A mode: the probability is that of a pose within 1 m, not of this pose alone.
struct WeightedMode {
  Hypothesis best;
  double probability = 0;
};

/// Modes of a view of this size in a map of so many nodes, further than 0.3 m or 0.2 rad
/// apart: the 20 of best score, most probable first. Modes further than 1 m apart weigh by the
/// evidence between the best of each place; without that, as all others, by their scores.
std::vector<WeightedMode> pose_posterior(std::span<const Hypothesis> hypotheses,
                                         const ViewSize& view,
                                         std::size_t nodes,
                                         const PosteriorOptions& options = {},
                                         const EvidenceBetween& evidence_between = {});

}  // namespace vernier::localise::internal
