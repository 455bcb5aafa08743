// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/rig_drift.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

#include "calib/calibration/combine_evidence.h"
#include "calib/calibration/pairs_alone.h"
#include "calib/combine.h"
#include "calib/error.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

/// Least fraction by which a batch reduces the variance of a parameter to say anything of its
/// drift. Of one that it reduces by less, as the length of the baseline, the offset is of second
/// order in those of the others (t_x with the square of t_z), which no covariance has.
constexpr double least_told = 0.1;

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& C) {
  const Eigen::MatrixXd white = ScaledRoot(C).white;
  return white.transpose() * white;
}

/// A solution with pairs.
struct Solution {
  Eigen::MatrixXd bound;   ///< C
  Eigen::MatrixXd before;  ///< information of what it knows beside the pairs
  double scatter = 1;      ///< s
};

/// `before`: what is known beside the pairs.
Solution solution_of(const RigEstimate& estimate, const Eigen::MatrixXd& before) {
  Solution solution{*estimate.covariance_mvb, before, 1};
  const Eigen::MatrixXd& C = solution.bound;
  const Eigen::MatrixXd from_before = C * before * C;
  const double bound = (before * (C - from_before)).trace();
  if (bound > 0) {
    const Eigen::MatrixXd from_pairs = estimate.covariance->matrix - from_before;
    solution.scatter = std::max(1.0, (before * from_pairs).trace() / bound);
  }
  return solution;
}

/// Of B x for an x of covariance H, as the scores of pairs whose information that is.
Eigen::VectorXd variances(const Eigen::MatrixXd& B, const Eigen::MatrixXd& H) {
  return (B * H * B.transpose()).diagonal().cwiseMax(0);
}

/// The variances of the offset of a batch.
Eigen::VectorXd variance_of_offset(const Solution& all,
                                   const Solution& batch,
                                   const Eigen::MatrixXd& C_0,
                                   bool is_used) {
  const double u = is_used ? 1 : 0;
  const Eigen::MatrixXd A = batch.bound * batch.before - all.bound * all.before;
  const Eigen::MatrixXd H_batch = pseudo_inverse(batch.bound) - batch.before;
  const Eigen::MatrixXd H_rest = pseudo_inverse(all.bound) - all.before - u * H_batch;
  return variances(A, C_0) +
         (is_used ? all : batch).scatter * variances(batch.bound - u * all.bound, H_batch) +
         all.scatter * variances(all.bound, H_rest);
}

}  // namespace

std::vector<MonitoredBatch> monitor(const std::vector<CombineInput>& inputs,
                                    const Combination& combination) {
  JointEvidence evidence = combination.evidence;
  evidence.pairs = {};
  const RigEstimate& all = combination.joint.estimate;
  const RigEstimate before = calibrate_jointly(evidence, all.rig, combination.options).estimate;
  const GaussianRigPrior known = gaussian_prior_of(before, "previous inputs");
  const Eigen::MatrixXd C_0 = full_covariance(known).matrix;
  const Solution of_all = solution_of(all, pseudo_inverse(*before.covariance_mvb));
  std::vector<MonitoredBatch> batches;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const PairObservations pairs = evidence_of(inputs[i]).pairs;
    if (pairs.size() == 0) continue;
    const bool is_used = combination.inputs[i].used;
    MonitoredBatch& batch = batches.emplace_back();
    batch.name = inputs[i].name;
    batch.pairs = pairs.size();
    batch.agreement = combination.inputs[i].agreement;
    batch.is_all = is_used && batch.pairs == combination.evidence.pairs.size();
    batch.offset = batch.sigma = Eigen::VectorXd::Zero(C_0.rows());
    try {
      const PairsAlone alone = pairs_alone(pairs, known, combination.options, Loosened::poses);
      const RigEstimate& own = alone.joint.estimate;
      const Eigen::MatrixXd C_wide =
          full_covariance(loosened(known, alone.wider, Loosened::poses)).matrix;
      const Solution of_batch = solution_of(own, pseudo_inverse(C_wide));
      batch.outliers = alone.outliers();
      batch.rms_px = own.calibration->rms_px;
      batch.offset = difference(own.rig, all.rig);
      const auto told =
          (C_wide - of_batch.bound).diagonal().array() > least_told * C_wide.diagonal().array();
      batch.sigma = told.select(variance_of_offset(of_all, of_batch, C_0, is_used).cwiseSqrt(), 0);
    } catch (const Error& error) {
      batch.failure = error.fault();
    }
  }
  return batches;
}

}  // namespace vernier::internal
