// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig.h"

namespace vernier::internal {

/// The rows of one view: from `first` on, u of all corners and then v of all corners.
struct ViewRows {
  int camera = 0;
  std::vector<int> ids;
  Eigen::Index first = 0;
};

/// One frame of a linearised calibration: residuals r (prediction minus pixel) and what moves them.
/// Pixels; one row per coordinate.
struct FrameRows {
  int frame = 0;
  std::vector<ViewRows> views;               ///< by camera
  std::vector<Eigen::Matrix3d> motion_axes;  ///< of each camera but the first
  Eigen::VectorXd residual_px;
  Eigen::MatrixXd by_rig;  ///< A: by the free directions of the rig, then the warp if it is free
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose;   ///< B: by the left tangent of T_first_board
  Eigen::MatrixXd by_motion;                          ///< M: rotation (rad), translation (m); below
  Eigen::Matrix<double, Eigen::Dynamic, 3> by_point;  ///< D: by the corner in the board's frame (m)
};

/// Appends a column to those of the rig for each unknown of the board: the displacements of the
/// points in the board's frame by it, 3 x points of the target.
void add_board_unknowns(const std::vector<Eigen::Matrix3Xd>& board, FrameRows& rows);

/// Columns: the direction from the first camera to this one, in the first one's frame, and two
/// across it; the axes of the first camera if both are in one place.
Eigen::Matrix3d motion_axes(const Rig& rig, int camera);

/// Of every frame of the state. The motion of the board has six columns for each camera but the
/// first: it turns about the mean of the frame's corners, about the axes of the first camera, and
/// moves along motion_axes(), before the exposure of that camera. `free` holds the free directions
/// of the rig (calib/estimate/held_parameters.h), parameters x free.
std::vector<FrameRows> frame_rows(const BoardObservations& observations,
                                  const BoardState& state,
                                  const Eigen::MatrixXd& free,
                                  BoardWarp warp = BoardWarp::known);

}  // namespace vernier::internal
