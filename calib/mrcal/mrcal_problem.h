// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// Residuals of an mrcal problem and their sparse Jacobian, one row per measurement, in full units
/// (pixels by pixels, radians, metres). Rows of unobserved corners are zero.
struct MrcalEvaluation {
  Eigen::VectorXd residual_px;
  std::vector<int> row_start;  ///< rows + 1 of them
  std::vector<int> state;      ///< of each entry
  std::vector<double> value;   ///< of each entry
};

/// A board calibration in mrcal's layout, without outlier rejection, regularisation and board
/// shape, so the cost is exactly Σ |project − q|².
///
/// The state is one vector: the lens parameters of every camera, the poses (rotation vector,
/// translation) of every camera but the first, the poses of the board.
class MrcalProblem {
 public:
  /// Throws Error if mrcal is not built in or cannot express the problem.
  MrcalProblem(const BoardObservations& observations, const BoardState& start);
  ~MrcalProblem();

  Eigen::VectorXd& state();
  int rig_states() const;                      ///< number of states before the board poses
  const std::vector<int>& frame_rows() const;  ///< first measurement of each frame, and the end
  Eigen::VectorXd packing_scales() const;      ///< a state over mrcal's own unitless one

  /// mrcal_optimize from the current state. Throws Error if it fails.
  void optimise();
  /// mrcal_optimizer_callback at the current state.
  MrcalEvaluation evaluate() const;

  /// The current state in our form, with names, models and frames from `like`.
  BoardState board_state(const BoardState& like) const;

 private:
  struct Layout;
  std::unique_ptr<Layout> layout_;
};

/// Whether this build has libmrcal, and the version it was built with ("2.2").
bool mrcal_available();
const char* mrcal_version();

}  // namespace vernier::internal
