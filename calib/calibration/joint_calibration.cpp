// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/joint_calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_state.h"
#include "calib/calibration/change_findings.h"
#include "calib/calibration/cluster_robust_covariance.h"
#include "calib/calibration/joint_minimum.h"
#include "calib/calibration/joint_summary.h"
#include "calib/calibration/merged_boards.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/pair_checks.h"
#include "calib/calibration/pair_sides.h"
#include "calib/calibration/result_checks.h"
#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/error.h"
#include "calib/estimate/covariance_curvature.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/observability.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/loss.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/pair_equations.h"

namespace vernier {

using namespace internal;

namespace {

/// Below it, data and prior contradict each other.
constexpr double largest_conflicting_p = 1e-4;

/// The equations of boards and pairs, in all parameters.
ReducedNormalEquations data_equations(const JointMinimum& joint,
                                      const PairObservations& pairs,
                                      const Loss& loss) {
  ReducedNormalEquations sum = board_equations(joint);
  if (pairs.size() > 0) {
    add_equations(sum, pair_equations(pairs, joint.state.rig, loss, joint.cost.pair_sigma_scale));
  }
  return sum;
}

/// The same in the free directions, with priors.
ReducedNormalEquations free_equations(const JointMinimum& joint,
                                      const PairObservations& pairs,
                                      const Loss& loss,
                                      const Eigen::MatrixXd& free) {
  ReducedNormalEquations equations = restricted(data_equations(joint, pairs, loss), free);
  add_priors(equations, joint.cost.priors, joint.state.rig, free);
  return equations;
}

PairObservations inliers_of(const JointMinimum& joint) {
  std::vector<bool> kept;
  for (std::size_t i = 0; i < joint.cost.pairs.size(); ++i) kept.push_back(!is_outlier(joint, i));
  return selected(joint.cost.pairs, kept);
}

/// Clusters of the scores: image pairs, or cells of them if there are fewer than three.
PairObservations clustered_pairs(const JointMinimum& joint) {
  const PairObservations& pairs = joint.cost.pairs;
  if (pairs.image_pairs.size() >= 3 || !joint.boards.observations.views.empty()) return pairs;
  return split_into_cells(pairs, joint.state.rig.cameras[0].size_px);
}

JointMinimum start_of(const JointEvidence& evidence,
                      const Rig& start,
                      const JointOptions& options) {
  if (!(options.pair_sigma_scale >= 0 && std::isfinite(options.pair_sigma_scale))) {
    throw Error(
        "pair_sigma_scale", "it is not a number from 0 on",
        "give by how much the stated noise of the pairs is multiplied, or 0 to estimate it");
  }
  JointMinimum joint;
  joint.boards = merge_boards(evidence.boards, start);
  joint.terms = evidence.boards;
  joint.state = joint.boards.state;
  joint.state.rig = with_held_values(start, options.held);
  joint.cost.pixel_sigma_px = joint.boards.pixel_sigma_px;
  joint.cost.corner_weights = joint.boards.corner_weights;
  joint.cost.warp = joint.boards.warp;
  joint.cost.held = held_mask(start, options.held);
  const auto& mask = joint.cost.held;
  if (!mask.empty() && std::find(mask.begin(), mask.end(), false) == mask.end()) {
    throw Error("calibration", "every parameter is fixed", "free at least one");
  }
  joint.cost.pairs = evidence.pairs;
  joint.packed = PackedPairs(evidence.pairs);
  for (const GaussianRigPrior& prior : evidence.priors) {
    joint.cost.priors.push_back(rig_prior(start, prior));
  }
  return joint;
}

/// The information added by the pairs, if priors and boards alone determine the rig.
std::optional<Observability> what_pairs_brought(const JointMinimum& joint,
                                                const JointEvidence& evidence,
                                                const Eigen::MatrixXd& free,
                                                const std::vector<std::string>& names,
                                                const Eigen::MatrixXd& bound) {
  if (evidence.pairs.size() == 0) return {};
  ReducedNormalEquations before = free_equations(joint, {}, {}, free);
  try {
    return observability(joint.state.rig, names, minimum_variance_bound(before, names), bound);
  } catch (const Error&) {
    return {};  // without the pairs something is free
  }
}

/// A calibration from pairs and a prior, before the judgement of its result.
struct PairSolution {
  JointCalibration joint;
  std::vector<std::string> unlisted;  ///< held, since the prior does not name them
  PriorConsistency agreement;
  SideVerdict sides = SideVerdict::as_given;
};

PairSolution solve_pairs(const PairObservations& pairs,
                         const GaussianRigPrior& prior,
                         const JointOptions& options) {
  const std::string& place = options.place;
  JointOptions with_held = options;
  PairSolution solution;
  for (const HeldParameter& held : held_by(prior)) {
    const bool twice = std::any_of(options.held.begin(), options.held.end(),
                                   [&](const HeldParameter& h) { return h.name == held.name; });
    if (twice) continue;
    with_held.held.push_back(held);
    solution.unlisted.push_back(held.name);
  }
  const std::vector<std::string> names = parameter_names(prior.rig);
  for (HeldParameter& held : with_held.held) {  // at the prior's values
    const auto at = std::find(names.begin(), names.end(), held.name);
    if (held.value || at == names.end()) continue;
    held.value = parameters(prior.rig)[at - names.begin()];
  }
  const std::vector<bool> mask = held_mask(prior.rig, with_held.held);
  const auto free = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), false));
  if (pairs.size() < free) {
    throw Error(place.empty() ? "pairs" : place,
                fmt::format("{} pairs for {} free parameters", pairs.size(), free),
                "match more corners, or fix parameters");
  }
  check_sides(pairs, prior.rig, full_covariance(prior).matrix, place);
  JointEvidence evidence;
  evidence.priors.push_back(prior);
  evidence.pairs = pairs;
  solution.joint = calibrate_jointly(evidence, prior.rig, with_held);
  solution.agreement = consistency_with(prior, solution.joint.estimate);
  solution.sides = judge_sides(pairs, prior, with_held, solution.joint,
                               solution.agreement.p_value < largest_conflicting_p);
  return solution;
}

}  // namespace

JointCalibration calibrate_jointly(const JointEvidence& evidence,
                                   const Rig& start,
                                   const JointOptions& options) {
  JointMinimum joint = start_of(evidence, start, options);
  if (options.reject_outliers && evidence.pairs.size() > 0) {
    minimise_robust(joint, options.pair_sigma_scale);
  } else {
    minimise_least_squares(joint, options.pair_sigma_scale);
  }
  const Eigen::MatrixXd free = free_directions(joint.state.rig, joint.cost.held);
  const std::vector<std::string> names = free_names(joint.state.rig, joint.cost.held);
  const PairObservations inliers = inliers_of(joint);
  const ReducedNormalEquations plain = free_equations(joint, inliers, {}, free);
  const Eigen::MatrixXd bound = minimum_variance_bound(plain, names);
  const PairObservations pairs = clustered_pairs(joint);
  const ReducedNormalEquations robust = free_equations(joint, pairs, joint.loss, free);
  Covariance honest{CovarianceKind::mvb, names, bound};
  const std::size_t clusters = robust.frame_information.size();
  if (clusters == 0) {
    honest.kind = CovarianceKind::combined;  // of priors
  } else if (!options.white_noise && clusters >= 3) {
    const auto frames = static_cast<Eigen::Index>(clusters - pairs.image_pairs.size());
    honest = cluster_robust_covariance(robust, minimum_variance_bound(robust, names), names,
                                       {.of_first_kind = frames});
  }
  const auto expand = [&](const Eigen::MatrixXd& C) -> Eigen::MatrixXd {
    return free * C * free.transpose();
  };
  JointCalibration result;
  result.pair_sigma_scale = joint.cost.pair_sigma_scale;
  result.observability = what_pairs_brought(joint, evidence, free, names, bound);
  RigEstimate& estimate = result.estimate;
  estimate.rig = joint.state.rig;
  estimate.covariance_mvb = expand(bound);
  estimate.covariance =
      Covariance{honest.kind, parameter_names(estimate.rig), expand(honest.matrix)};
  estimate.calibration = summary_of(joint, evidence, inliers, plain, bound);
  for (const HeldParameter& held : options.held) {
    estimate.calibration->held.push_back(held.name);
  }
  if (joint.boards.warps_assumed_known) {
    estimate.calibration->warnings.push_back(
        "the views are of different boards; the warp estimated for each is taken as known");
  }
  std::optional<PairChange> change;
  if (inliers.size() > 0) change = change_finding(inliers, joint.state.rig);
  warn(result, evidence, change, options, *estimate.calibration);
  estimate.evidence = merged_evidence(joint.boards, joint.state);
  estimate.evidence->pairs = evidence.pairs;
  estimate.evidence->priors = evidence.priors;
  return result;
}

SideVerdict internal::judge_sides(const PairObservations& pairs, const GaussianRigPrior& prior) {
  return solve_pairs(pairs, prior, {}).sides;
}

JointCalibration calibrate_from_pairs(const PairObservations& pairs,
                                      const GaussianRigPrior& prior,
                                      const JointOptions& options) {
  check_pairs(pairs, prior.rig, options.place);
  PairSolution solution = solve_pairs(pairs, prior, options);
  JointCalibration& result = solution.joint;
  std::vector<bool> inlier(pairs.size(), true);
  for (const PairOutlier& out : result.estimate.calibration->pair_outliers) inlier[out.row] = false;
  const ObservationDiagnosis diagnosis =
      check_scene(selected(pairs, inlier), result.estimate.rig, result.pair_sigma_scale);
  auto& summary = *result.estimate.calibration;
  doubt_sides(solution.sides, options.place, summary);
  const PriorConsistency& agreement = solution.agreement;
  if (agreement.p_value < largest_conflicting_p) {
    summary.trust_warnings.push_back(
        fmt::format("pairs and prior are inconsistent (chi² {:.1f} for {}, p {:.1g}; {:.1f} sigma "
                    "where {}): the rig has changed, or one of them understates its uncertainty",
                    agreement.chi2, agreement.dof, agreement.p_value, agreement.in_sigma,
                    agreement.description));
  }
  if (!solution.unlisted.empty()) {
    summary.warnings.push_back(fmt::format("fixed, since the prior gives them no variance: {}",
                                           fmt::join(solution.unlisted, ", ")));
  }
  const auto folds = inversion_warnings(result.estimate.rig);
  summary.warnings.insert(summary.warnings.end(), folds.begin(), folds.end());
  const auto curved = curvature_warning(result.estimate.rig, *result.estimate.covariance);
  if (curved) summary.trust_warnings.push_back(*curved);
  summary.warnings.insert(summary.warnings.begin(), diagnosis.warnings.begin(),
                          diagnosis.warnings.end());
  summary.trust_warnings.insert(summary.trust_warnings.begin(), diagnosis.trust_warnings.begin(),
                                diagnosis.trust_warnings.end());
  return std::move(result);
}

}  // namespace vernier
