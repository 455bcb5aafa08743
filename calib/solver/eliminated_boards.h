// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/board_state.h"
#include "calib/rig.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/packed_views.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// The reduced system in the tangent of (rig, warp if free).
struct ReducedSystem {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient, diagonal;
  double chi2 = 0, frames_drop = 0;
};

/// A linearised board calibration with the board poses eliminated, and the back-substitution: used
/// for the re-solver's steps. Keeps the result of the last linearisation.
class EliminatedBoards {
 public:
  EliminatedBoards(const PackedViews& views,
                   const ReprojectionProblem& cost,
                   std::vector<Lanes> pixels,
                   int parameters,
                   int threads);

  ReducedSystem linearise(const BoardState& state, double damping);
  /// The state after a step of rig and warp; the boards follow by the last linearisation.
  BoardState moved(const BoardState& state, const Eigen::VectorXd& step) const;

 private:
  void sum_chunk(const BoardState& state,
                 const std::vector<CameraTransform>& places,
                 const std::vector<Eigen::VectorXd>& intrinsics,
                 double damping,
                 std::size_t chunk);
  ReducedSystem reduced() const;
  Eigen::MatrixXd kernel_by_step(const Rig& rig) const;

  const PackedViews& views_;
  const ReprojectionProblem& cost_;
  std::vector<Lanes> pixels_;
  int parameters_, threads_;
  std::vector<Lanes> factors_;
  std::vector<ReducedSums> chunks_;
};

/// The free directions E of (rig, warp), one per column; empty if all are free.
Eigen::MatrixXd directions(const Rig& rig, const std::vector<bool>& held, int parameters);

}  // namespace vernier::internal
