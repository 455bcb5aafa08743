// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board/board_placement.h"
#include "calib/rig.h"
#include "calib/uncertainty/target_quantity.h"

namespace vernier::internal {

/// The information of one more view about a rig.
struct CandidateView {
  BoardPlacement placement;
  Eigen::MatrixXd
      information;  ///< S_f of calib/solver/normal_equations.h, the board's pose eliminated
};

/// A view with its effect on the standard deviation of the target quantity.
struct ScoredView {
  BoardPlacement placement;
  double sd_before = 0, sd_after = 0;  ///< in the unit of the target quantity
};

struct ViewAdvice {
  std::vector<ScoredView> views;         ///< in order, each given the previous ones
  std::vector<ScoredView> alternatives;  ///< to the first, best first, no two adjacent
  ScoredView worst_candidate;            ///< of all candidates, as a first view
  std::vector<double> sd_after_more;     ///< after 1, 2, … more views chosen in the same way
};

struct ViewAdviceOptions {
  int views = 1;
  int alternatives = 5;
  int more = 10;  ///< length of sd_after_more
};

/// The information of a view at each of the placements, for independent noise of `pixel_sigma_px`
/// on every coordinate. `warp_m` is the board's (calib/board/board_warp.h), assumed known.
std::vector<CandidateView> candidate_views(const Rig& rig,
                                           const std::vector<Eigen::Vector3d>& target_m,
                                           const Eigen::Vector2d& warp_m,
                                           double pixel_sigma_px,
                                           const PlacementOptions& options = {});

/// The factor of the covariance after adding `times` independent views with this information:
///
///     C' = (C⁻¹ + n S)⁻¹ = F (I + n Fᵀ S F)⁻¹ Fᵀ,   C = F Fᵀ
///
/// which also holds if C is singular (held parameters stay held).
Eigen::MatrixXd updated_factor(const Eigen::MatrixXd& factor,
                               const Eigen::MatrixXd& information,
                               double times = 1);

/// Greedy choice: every view is the candidate with the smallest standard deviation of the target
/// quantity, given those before it. (Each is the best next one; the best set of n may differ a
/// little. The variance is convex and decreasing in the information: Pukelsheim, "Optimal Design of
/// Experiments", 1993.) `factor` is that of the current covariance. Throws Error if there is no
/// candidate, or if the standard deviation is already zero (its parameters are held).
ViewAdvice advise_views(const Eigen::MatrixXd& factor,
                        const std::vector<CandidateView>& candidates,
                        const TargetQuantity& wanted,
                        const ViewAdviceOptions& options = {});

}  // namespace vernier::internal
