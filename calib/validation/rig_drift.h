// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calib/combine.h"
#include "calib/data_and_prior.h"

namespace vernier::internal {

/// The rig estimated from one batch of pairs.
struct MonitoredBatch {
  std::string name;
  std::size_t pairs = 0, outliers = 0;
  double rms_px = 0;       ///< Sampson distances of the batch's pairs from its own rig
  Eigen::VectorXd offset;  ///< from the combined rig, in its tangent
  /// Standard deviation of that offset; 0 where the batch says little of the parameter: it reduces
  /// the variance that its prior allows by less than a tenth.
  Eigen::VectorXd sigma;
  PriorConsistency agreement;  ///< with the previous inputs
  bool is_all = false;         ///< the only batch in the combination, so drift is not observable
  std::string failure;  ///< why the batch has no rig of its own; then no offset, sigma and rms
};

/// Drift: the rig that every batch of pairs wants itself (calib/calibration/pairs_alone.h),
/// compared with the combined rig. The batch's prior is what `combination` knew before any pairs,
/// with the cameras' poses k times wider, as if these had moved since: a prior that is sure of the
/// poses would draw the offset towards nothing. With C the bounds of the batch (b) and of all (a),
/// e_0 the error of what was known, of covariance C_0, P its information in the combination and P'
/// that of the batch's prior, H the information of pairs, g their scores, and u = 1 for a batch
/// that is part of the combination, else 0,
///
///     offset = (C_b P' − C_a P) e_0 + (C_b − u C_a) g_b − C_a g_rest
///
/// which has the covariance
///
///     A C_0 Aᵀ + s_b (C_b − u C_a) H_b (C_b − u C_a) + s C_a H_rest C_a,    A = C_b P' − C_a P
///
/// with s the ratio of the scatter of pairs to the bound in the whole combination, and s_b that of
/// a batch that is no part of it, each in the mean over the directions that they improved.
std::vector<MonitoredBatch> monitor(const std::vector<CombineInput>& inputs,
                                    const Combination& combination);

}  // namespace vernier::internal
