// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_target.h"
#include "calib/interval.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"

namespace vernier::internal {

/// Views that could follow and that the same cameras see.
struct PlannedViews {
  double share = 1;                    ///< of all views that could follow
  std::vector<int> cameras;            ///< that see the board, ascending
  bool by_all = true;                  ///< these are all cameras, or all that were chosen
  int taken = 0;                       ///< number of views so far that these see
  bool drawn = true;                   ///< poses were drawn; false: views so far, again
  std::vector<Eigen::MatrixXd> views;  ///< information S_f of each, at 1 px; free x free
};

/// Views that could be taken, one guess of the rig and of how the board is held.
struct ViewPool {
  Rig rig;
  Eigen::MatrixXd free;  ///< what is estimated moves the rig so: parameters x free
  std::vector<Eigen::MatrixXd>
      taken;  ///< information S_f of the views so far, at 1 px; free x free
  std::vector<PlannedViews> following;  ///< shares that sum to 1
  Eigen::MatrixXd prior;  ///< information of the calibration's priors, free x free; empty: none
};

/// What the scatter between the views so far says of a calibration.
struct NoiseByScatter {
  /// Of each view to the parameters, parameters x views; empty: none.
  Eigen::MatrixXd contributions;
  double in_sigma = 1;  ///< root of their mean square over what σφ gives
};

/// What is known before more views are taken. The standard deviation of a quantity with gradient g
/// after views f is
///
///     sd² = g (P + Σ_f S_f / (σ φ)²)⁻¹ gᵀ
///
/// with S_f the information of a view at 1 px (calib/solver/normal_equations.h), P that of priors,
/// σ the noise of a coordinate, and φ² the inflation of the bound by noise that is correlated
/// within a view.
///
/// Such noise is not of equal power in all modes over the board that are called smooth, and does
/// not move all quantities alike, while the F views so far have a scatter of their own
/// (calib/calibration/cluster_robust_covariance.h). With m the root of the mean square of what it
/// makes of the parameters over what σφ does, r that of the quantity alone, times e^(1 / 2ν) as the
/// logarithm of a root of few squares is too small, and ν + 1 the number of views that determine
/// the quantity (1 / Σ h², with h the fraction of a view in its information), σφ is multiplied by
/// m^(u (1 − w)) r^w, where
///
///     u = τ² / (τ² + 1 / (8 (F − 1))),   w = τ² / (τ² + 1 / 2ν),   τ = 0.5 (1 − 1/φ²)
///
/// are the weights of logarithms known to 1/√(8 (F − 1)) (calib/statistics/scatter_dof.h) and
/// 1/√2ν against a prior of standard deviation τ, none for white noise. It is known to τ √(1 − w)
/// then.
struct ViewKnowledge {
  std::vector<ViewPool> pools;
  int taken = 0;            ///< number of views so far
  double noise_px = 0;      ///< σ φ
  double inflation = 1;     ///< φ²
  double noise_log_sd = 0;  ///< standard deviation of the logarithm of σ φ
  NoiseByScatter by_scatter;

  /// Of a coordinate: root of the mean square of the residuals.
  double residual_px() const { return noise_px / std::sqrt(inflation); }
  /// Number of views so far that all cameras see, or all that were chosen.
  int taken_by_all() const;
};

/// From a calibration, by its evidence: σ φ is the noise of its residuals that varies smoothly over
/// the board (calib/planning/smooth_noise.h). Each pool has views of the calibration's pose
/// population, redrawn (calib/planning/view_population.h), one for the frames of each set of
/// cameras that see the board (calib/planning/frame_kinds.h), in shares that are redrawn too. A set
/// with fewer than three frames is taken to hold the board as all frames that its first camera
/// sees; where hardly any pose shows the whole board, as in frames that cut it, the views so far
/// are drawn again, with replacement. Throws Error(`place`) if the estimate has no evidence of
/// board views, or of fewer than five. Priors of the calibration count.
ViewKnowledge knowledge_of(const RigEstimate& calibration,
                           std::uint64_t seed,
                           const std::string& place);

/// From a rig's datasheet and a board, without any view: each pool is of another rig, drawn from
/// the covariance, if it has one, with simulated views (calib/simulated_board.h: distance and tilt
/// as in `views`, whose number of frames and set of poses are ignored). The noise is that of
/// `views`, known to a fifth. Throws Error(`place`) if no rig that is drawn sees the board.
ViewKnowledge knowledge_of_datasheet(const RigEstimate& datasheet,
                                     const Chessboard& board,
                                     const SimulatedBoardOptions& views,
                                     const std::string& place);

/// The same for a rig of some of the cameras (calib/estimate/rig_part.h: part_of), by the views of
/// all. A view is by all if all of these see it.
ViewKnowledge for_cameras(const ViewKnowledge& known, const std::vector<int>& cameras);

/// The same, if all cameras are to see every further view; nothing if none so far is seen so, or so
/// few that only these could be repeated.
std::optional<ViewKnowledge> with_views_by_all(const ViewKnowledge& known);

struct ViewPlanOptions {
  double confidence = 0.95;       ///< of intervals
  double widest = 2;              ///< upper over lower end of an interval of views, at most …
  double least_confidence = 0.8;  ///< … where it has this confidence; else the narrowest that has
  int most_views = 2000;
  int sequences = 400;  ///< of views, shared among the pools
  std::uint64_t seed = 1;
  /// How well the target of views_needed is itself known: standard deviations of its logarithm
  /// towards smaller and larger targets.
  double target_log_sd_below = 0, target_log_sd_above = 0;
};

/// The number of views in all, those taken included and at least three, after which a standard
/// deviation is at its target for the first time, as views are added one by one.
struct ViewsNeeded {
  int views = 0;           ///< the median, or the end of the interval next to it
  Interval interval;       ///< `confidence` of the sequences lie within
  double confidence = 0;   ///< that of the options, or less, where the interval would be too wide
  bool is_reached = true;  ///< false: the upper end lies above most_views, the median perhaps too
};

/// The standard deviation of a quantity (target_quantity) after `views` views.
struct SdAfter {
  int views = 0;
  double sd = 0;      ///< the median
  Interval interval;  ///< `confidence` of the sequences lie within
};

/// Simulated: each sequence draws a pool, the noise, the target and views of the pool, by (seed,
/// sequence).
/// `what` and `at_m` are those of target_quantity, which throws Error.
ViewsNeeded views_needed(const ViewKnowledge& known,
                         const std::string& what,
                         double at_m,
                         double target_sd,
                         const ViewPlanOptions& options = {});

/// After each of the numbers of views, ascending, those taken included.
std::vector<SdAfter> sd_after(const ViewKnowledge& known,
                              const std::string& what,
                              double at_m,
                              const std::vector<int>& numbers,
                              const ViewPlanOptions& options = {});

}  // namespace vernier::internal
