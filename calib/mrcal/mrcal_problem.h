// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// Residuals of a problem of mrcal's and their sparse Jacobian, one row a measurement, in full
/// units (pixels by pixels, radians, metres). Rows of corners that were not seen are zero.
struct MrcalEvaluation {
  Eigen::VectorXd residual_px;
  std::vector<int> row_start;  ///< rows + 1 of them
  std::vector<int> state;      ///< of each entry
  std::vector<double> value;   ///< of each entry
};

/// A board calibration laid out as mrcal wants it. Outlier rejection, regularisation and the shape
/// of the board are not among the unknowns, so the cost is Σ |project − q|² and nothing else.
///
/// The state is one vector: the lens parameters of every camera, the poses (rotation vector,
/// translation) of every camera but the first, the poses of the board.
class MrcalProblem {
 public:
  /// Throws Error where mrcal is not built in or cannot express the problem.
  MrcalProblem(const BoardObservations& observations, const BoardState& start);
  ~MrcalProblem();

  Eigen::VectorXd& state();
  int rig_states() const;                      ///< how many come before the board poses
  const std::vector<int>& frame_rows() const;  ///< first measurement of each frame, and the end
  Eigen::VectorXd packing_scales() const;      ///< a state over mrcal's own unitless one

  /// mrcal_optimize from the present state. Throws Error where it fails.
  void optimise();
  /// mrcal_optimizer_callback at the present state.
  MrcalEvaluation evaluate() const;

  /// The present state as ours, with `like` for names, models and frames.
  BoardState board_state(const BoardState& like) const;

 private:
  struct Layout;
  std::unique_ptr<Layout> layout_;
};

/// Whether this build has libmrcal, and the version that it was built with ("2.2").
bool mrcal_available();
const char* mrcal_version();

}  // namespace vernier::internal
