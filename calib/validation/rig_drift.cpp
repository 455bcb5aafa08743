// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/rig_drift.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/calibration/combine_evidence.h"
#include "calib/combine.h"
#include "calib/joint_calibration.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

/// Least fraction by which a batch reduces the variance of a parameter to say anything of its
/// drift. Of one that it reduces by less, as the length of the baseline, the offset is of second
/// order in those of the others (t_x with the square of t_z), which no covariance has.
constexpr double least_told = 0.01;

/// Ratio of the pairs' contribution to an estimate's variance to that of the bound, in the mean
/// over the directions they improved, at least 1. C_0 is the bound before the pairs, P its inverse.
double scatter_of_pairs(const RigEstimate& estimate, const Eigen::MatrixXd& P) {
  const Eigen::MatrixXd& C = *estimate.covariance_mvb;
  const Eigen::MatrixXd from_before = C * P * C;
  const double bound = (P * (C - from_before)).trace();
  if (!(bound > 0)) return 1;
  return std::max(1.0, (P * (estimate.covariance->matrix - from_before)).trace() / bound);
}

}  // namespace

std::vector<MonitoredBatch> monitor(const std::vector<CombineInput>& inputs,
                                    const Combination& combination) {
  JointEvidence before = combination.evidence;
  before.pairs = {};
  const RigEstimate& all = combination.joint.estimate;
  const Eigen::MatrixXd& C_all = *all.covariance_mvb;
  const JointOptions& how = combination.options;
  const Eigen::MatrixXd C_before = *calibrate_jointly(before, all.rig, how).estimate.covariance_mvb;
  const Eigen::MatrixXd white = ScaledRoot(C_before).white;
  const Eigen::MatrixXd P = white.transpose() * white;
  const double scatter = scatter_of_pairs(all, P);
  std::vector<MonitoredBatch> batches;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const bool used = combination.inputs[i].used;
    JointEvidence evidence = before;
    evidence.pairs = evidence_of(inputs[i]).pairs;
    if (evidence.pairs.size() == 0) continue;
    const RigEstimate alone = calibrate_jointly(evidence, all.rig, how).estimate;
    const Eigen::MatrixXd& C = *alone.covariance_mvb;
    const Eigen::MatrixXd G = C - C_all;
    const Eigen::VectorXd of_before = (G * P * G).diagonal();
    const Eigen::VectorXd bound = used
                                      ? Eigen::VectorXd(G.diagonal())
                                      : Eigen::VectorXd((C + C_all - 2 * C * P * C_all).diagonal());
    MonitoredBatch& batch = batches.emplace_back();
    batch.name = inputs[i].name;
    batch.pairs = evidence.pairs.size();
    batch.outliers = alone.calibration->pair_outliers.size();
    batch.rms_px = alone.calibration->rms_px;
    batch.offset = difference(alone.rig, all.rig);
    const auto told = (C_before - C).diagonal().array() > least_told * C_before.diagonal().array();
    batch.sigma = (scatter * (bound - of_before).cwiseMax(0) + of_before).cwiseSqrt();
    batch.sigma = told.select(batch.sigma, 0);
    batch.agreement = combination.inputs[i].agreement;
    batch.is_all = used && batch.pairs == combination.evidence.pairs.size();
  }
  return batches;
}

}  // namespace vernier::internal
