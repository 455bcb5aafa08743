// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/packed_views.h"
#include "calib/solver/parameter_buffer.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// The reprojection residuals of all views for Ceres: one block per view, with as many rows as its
/// system has columns. With J the derivatives of a view's 2n residuals r,
///
///     [J r]ᵀ [J r] = Uᵀ U,   U = [J' r'] upper triangular
///
/// so r' and J' have the cost, the gradient and the Gauss–Newton matrix of r and J at a tenth of
/// the size. A solver of normal equations, which squares them anyway, loses nothing. If only the
/// cost is requested, r' is (|r|, 0, …). All views are evaluated together before Ceres requests the
/// first, with the re-solver's kernels (calib/solver/view_kernel.h), in pixels.
class CompressedViews : public ceres::EvaluationCallback {
 public:
  /// Refers to `parameters`, which Ceres changes, during its lifetime.
  CompressedViews(const BoardObservations& observations,
                  const BoardState& start,
                  const ReprojectionProblem& problem,
                  const ParameterBuffer& parameters);

  void PrepareForEvaluation(bool jacobians, bool new_point) override;

  /// The block of a view, by its index in the observations. Its parameter blocks are the
  /// intrinsics, the board's pose, for every camera but the first the camera's pose, and the warp
  /// if it is free.
  std::unique_ptr<ceres::CostFunction> cost(std::size_t view) const;

 private:
  friend class ViewCost;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  /// Position of a view in the lanes.
  struct Place {
    std::size_t sums = 0;  // index of its packed triangle
    int lane = 0, camera = 0, frame = 0, columns = 0;
  };

  void evaluate_group(std::size_t group, bool jacobians);
  /// The derivative of the twist of T_camera_board with respect to the block of the board's pose.
  Matrix6 board_twist(const Place& place) const;

  PackedViews views_;
  const ParameterBuffer& parameters_;
  BoardState state_;
  std::vector<Lanes> pixels_;
  std::vector<Place> places_;                    // one per view
  std::vector<std::vector<std::size_t>> first_;  // of a group's camera: index of its sums
  std::vector<Lanes> sums_;  // triangles of U; of a view evaluated without, χ² in the first
  bool with_jacobians_ = false;
  std::vector<Matrix6> board_by_block_, camera_by_block_;  // twists by what Ceres moves
};

}  // namespace vernier::internal
