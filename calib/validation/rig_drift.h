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
  double rms_px = 0;
  Eigen::VectorXd offset;  ///< from the combined rig, in its tangent
  /// Standard deviation of that offset; 0 where the batch says nothing of the parameter: it reduces
  /// the variance from before the pairs by less than 1 %.
  Eigen::VectorXd sigma;
  PriorConsistency agreement;  ///< with the previous inputs
  bool is_all = false;         ///< the only batch in the combination, so drift is not observable
};

/// Drift: every batch of pairs is solved with what `combination` knew before any pairs, and
/// compared with the combined rig. With C the bounds of the batch (b) and of all (a), and P the
/// information before the pairs, common to both, the offset of a batch in the combination has by
/// the bounds the covariance C_b − C_a, and of an excluded one C_b + C_a − C_b P C_a − C_a P C_b.
/// Of that, (C_b − C_a) P (C_b − C_a) comes from before the pairs; the rest, from the pairs, is
/// multiplied by the ratio of their scatter to the bound in the whole combination, in the mean over
/// the directions they improved.
std::vector<MonitoredBatch> monitor(const std::vector<CombineInput>& inputs,
                                    const Combination& combination);

}  // namespace vernier::internal
