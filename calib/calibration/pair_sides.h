// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// On which side of a rig the corners of each image pair lie.
struct SideCounts {
  std::size_t judged = 0;    ///< image pairs with enough corners
  std::size_t right = 0;     ///< with their corners before the rig
  std::vector<int> swapped;  ///< numbers of those with corners behind it, but not if exchanged
};

/// A quarter of an image pair's corners lie before or behind the rig if they do so by more than 3
/// px and three of the standard deviations that `covariance`, over all its parameters, allows.
SideCounts count_sides(const PairObservations& pairs,
                       const Rig& rig,
                       const Eigen::MatrixXd& covariance);

enum class SideVerdict {
  as_given,
  exchanged,        ///< left and right are swapped
  interchangeable,  ///< neither corners nor prior tell left from right
  behind            ///< corners lie behind the solved rig, but exchanged they contradict the prior
};

/// Judges a calibration from pairs and prior (before its outliers are dropped) against the
/// hypothesis that left and right were exchanged. Epipolar geometry is the same with the baseline
/// reversed, so only the prior, and corners behind the solved rig, tell the sides apart. If the
/// corners are not clearly before the solved rig, or it contradicts the prior (`conflict`), the
/// exchanged pairs are solved too: they are the right ones if their cost, of prior and robust
/// residuals, is lower by more than 25 (χ² of one direction, p 6e-7), or not higher by more while
/// the given ones lie behind the rig; the sides are interchangeable if the costs differ by less and
/// no corners are clearly before either rig.
SideVerdict judge_sides(const PairObservations& pairs,
                        const GaussianRigPrior& prior,
                        const JointOptions& how,
                        const JointCalibration& given,
                        bool conflict);

/// Throws Error(`place`, or "pairs") if left and right are swapped; otherwise the verdict's trust
/// warning, if there is one.
void doubt_sides(SideVerdict verdict, const std::string& place, CalibrationSummary& summary);

/// judge_sides after solving the pairs with the prior. Throws Error as calibrate_from_pairs.
SideVerdict judge_sides(const PairObservations& pairs, const GaussianRigPrior& prior);

}  // namespace vernier::internal
