// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board/board_placement.h"
#include "calib/rig.h"
#include "calib/uncertainty/target_quantity.h"

namespace vernier::internal {

/// What one more view would tell of a rig.
struct CandidateView {
  BoardPlacement placement;
  Eigen::MatrixXd
      information;  ///< S_f of calib/solver/normal_equations.h, the board's pose eliminated
};

/// A view with what it would do to the wanted error.
struct ScoredView {
  BoardPlacement placement;
  double sd_before = 0, sd_after = 0;  ///< in the wanted error's unit
};

struct ViewAdvice {
  std::vector<ScoredView> views;         ///< to take one after the other, each given the former
  std::vector<ScoredView> alternatives;  ///< to the first, best first, none next to another
  ScoredView worst_candidate;            ///< of all the candidates, as a first view
  std::vector<double> sd_after_more;     ///< after 1, 2, … more views chosen in the same way
};

struct ViewAdviceOptions {
  int views = 1;
  int alternatives = 5;
  int more = 10;  ///< how far sd_after_more reaches
};

/// The information of a view at each of the placements, under independent noise of
/// `pixel_sigma_px` on every coordinate. `warp_m` is the board's (calib/board/board_warp.h), taken
/// as known.
std::vector<CandidateView> candidate_views(const Rig& rig,
                                           const std::vector<Eigen::Vector3d>& target_m,
                                           const Eigen::Vector2d& warp_m,
                                           double pixel_sigma_px,
                                           const PlacementOptions& options = {});

/// The factor of the covariance that `times` independent views with this information leave:
///
///     C' = (C⁻¹ + n S)⁻¹ = F (I + n Fᵀ S F)⁻¹ Fᵀ,   C = F Fᵀ
///
/// which also holds where C is singular (held parameters stay held).
Eigen::MatrixXd updated_factor(const Eigen::MatrixXd& factor,
                               const Eigen::MatrixXd& information,
                               double times = 1);

/// Greedy choice: every view is the candidate with the smallest standard deviation of the wanted
/// error, given those before it. (Each is the best next one; the best set of n may differ a
/// little. The variance is convex and decreasing in the information: Pukelsheim, "Optimal Design
/// of Experiments", 1993.) `factor` is that of the present covariance. Throws Error where there is
/// no candidate, or where the wanted error is already zero (what it depends on is held).
ViewAdvice advise_views(const Eigen::MatrixXd& factor,
                        const std::vector<CandidateView>& candidates,
                        const TargetQuantity& wanted,
                        const ViewAdviceOptions& options = {});

}  // namespace vernier::internal
