// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"

namespace vernier::internal {

struct SplitHalvesOptions {
  int splits = 100;
  std::uint64_t seed = 1;  ///< of the splits
  int threads = 0;         ///< 0: all; does not affect results
  CalibrationOptions calibration;
};

/// How far the calibrations of the two halves of a split are apart, in squared Mahalanobis distance
/// (calib/rig_difference.h).
struct HalvesDistance {
  double honest = 0;  ///< by `covariance`
  double mvb = 0;     ///< by the minimum variance bound
};

struct SplitHalvesResult {
  int frames = 0;  ///< of all views; the first half has half of them, rounded down
  int splits = 0;  ///< of which both halves could be calibrated
  int failed = 0;  ///< the others
  int dof = 0;     ///< degrees of freedom, the expected distance if the covariance is true
  double nees_mean_honest = 0, nees_mean_mvb = 0;  ///< mean squared distance over splits
  double inside_95_honest = 0, inside_95_mvb = 0;  ///< fraction of splits below chi2's 95 %
  std::vector<HalvesDistance> distances;           ///< of each split that counts, in order
  std::vector<std::string> names;                  ///< of the rig's parameters
  Eigen::VectorXd
      rms_difference;  ///< of the two halves, in the tangent of calib/rig.h, over splits
};

/// Calibrates two random halves of the frames apart, and compares them by their own covariances,
/// over many splits. If the covariance is true, the squared distance has the mean `dof` (normalised
/// estimation error squared; Bar-Shalom, Li and Kirubarajan 2001, section 5.4).
///
/// It tests the scatter from view to view. What all views share - board, square, lens model,
/// detector - is alike in both halves and cannot be seen. With a board's shape as a random effect
/// the error of that shape is in both covariances, though its prior's part is common to the halves:
/// the distance is then a little below that of independent halves. Splits share frames, so that
/// their distances are not independent: the mean over splits of one set of views varies more than
/// that of so many chi-squared values. Throws Error for fewer than six frames, for a prior, which
/// both halves would share, or if no split can be calibrated.
SplitHalvesResult compare_split_halves(
    const BoardObservations& observations,
    const SplitHalvesOptions& options = {},
    const std::function<void(int done, int total)>& progress = {});

}  // namespace vernier::internal
