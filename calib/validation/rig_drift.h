// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calib/combine.h"
#include "calib/data_and_prior.h"

namespace vernier::internal {

/// The rig as one batch of pairs alone saw it.
struct MonitoredBatch {
  std::string name;
  std::size_t pairs = 0, outliers = 0;
  double rms_px = 0;
  Eigen::VectorXd offset;  ///< from the combined rig, in its tangent
  Eigen::VectorXd sigma;   ///< standard deviation of that offset; 0 where the batch says nothing
  PriorConsistency agreement;  ///< with the inputs before it
  bool is_all = false;         ///< no other batch is in the combination: there is no drift to see
};

/// Drift: every batch of pairs solved with what `combination` knew before any pairs, beside the
/// combined rig. With C the bounds of the batch (b) and of all (a), and P the information from
/// before the pairs, which both have, the offset of a batch that is part of the combination has by
/// the bounds the covariance C_b − C_a, and of one that was left out C_b + C_a − C_b P C_a − C_a P
/// C_b. Of that (C_b − C_a) P (C_b − C_a) comes from before; the rest, from the pairs, is larger by
/// the factor by which their scatter is in the whole combination, in the mean over what they
/// improved.
std::vector<MonitoredBatch> monitor(const std::vector<CombineInput>& inputs,
                                    const Combination& combination);

}  // namespace vernier::internal
