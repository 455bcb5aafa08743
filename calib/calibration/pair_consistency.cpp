// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/prior_consistency.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/pair_equations.h"
#include "calib/statistics/scaled_root.h"

namespace vernier {

using namespace internal;

namespace {

/// Number of clusters of the pairs' scatter (clustered_pairs); 0 if their noise was known.
int clusters_of(const RigEstimate& estimate) {
  if (estimate.covariance->kind == CovarianceKind::mvb) return 0;
  const PairObservations& pairs = estimate.evidence->pairs;
  if (pairs.image_pairs.size() >= 3) return static_cast<int>(pairs.image_pairs.size());
  const Eigen::Vector2i& size_px = estimate.rig.cameras[0].size_px;
  return static_cast<int>(split_into_cells(pairs, size_px).image_pairs.size());
}

}  // namespace

PriorConsistency consistency_with(const GaussianRigPrior& prior,
                                  const RigEstimate& estimate,
                                  double looseness) {
  const Rig& rig = estimate.rig;
  const std::vector<std::string> all = parameter_names(rig);
  if (parameter_names(prior.rig) != all) return {};
  const std::vector<bool> held = held_parameters(estimate);
  const std::vector<std::string>& known = prior.covariance.names;
  std::vector<Eigen::Index> free, given;
  for (std::size_t i = 0; i < held.size(); ++i) {
    const bool is_known = std::find(known.begin(), known.end(), all[i]) != known.end();
    if (!held[i] && !is_known) return {};  // determined by the data alone
    if (is_known) (held[i] ? given : free).push_back(static_cast<Eigen::Index>(i));
  }
  const Eigen::MatrixXd V = values_by_tangent(prior.rig, held);
  const Eigen::MatrixXd C = V * full_covariance(prior).matrix * V.transpose();
  Eigen::VectorXd moved = values_by_tangent(rig, held) * difference(rig, prior.rig);
  Eigen::MatrixXd bound = covariance_of_free(*estimate.covariance_mvb, rig, held),
                  honest = covariance_of_free(estimate.covariance->matrix, rig, held);
  if (free.size() == held.size() && prior.covariance.kind != CovarianceKind::prior) {
    if (auto at = StableCoordinates(prior.rig, C).try_position(rig)) {
      moved = std::move(at->delta);
      bound = at->by_rig * bound * at->by_rig.transpose();
      honest = at->by_rig * honest * at->by_rig.transpose();
    }
  }
  Eigen::MatrixXd covariance = C(free, free);
  Eigen::VectorXd offset = moved(free);
  if (!given.empty()) {  // condition the prior on the values of its held parameters
    const Eigen::MatrixXd white = ScaledRoot(C(given, given)).white;
    const Eigen::MatrixXd by_given = C(free, given) * white.transpose();
    offset -= by_given * (white * moved(given));
    covariance -= by_given * by_given.transpose();
  }
  return prior_consistency(offset, free_names(rig, held),
                           {.prior = covariance, .bound = bound, .honest = honest},
                           {.clusters = clusters_of(estimate), .looseness = looseness});
}

}  // namespace vernier
