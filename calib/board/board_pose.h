// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

/// T_camera_board from one view and a known camera: the plane's homography on the undistorted
/// corners, refined in normalised coordinates (OpenCV's solvePnP). Throws Error if no pose fits.
Pose board_pose(const std::vector<Eigen::Vector3d>& target_m,
                const BoardView& view,
                const Camera& camera);

/// The pose of a board in a frame from all given views, with the rig known.
struct BoardPoseFit {
  Pose T_first_board;
  double rms_px = 0;  ///< per coordinate; infinite if the board is behind a camera
};

/// Minimises Σ |project(T_camera_first T_first_board X) − q|² over T_first_board from a start, by
/// Levenberg–Marquardt in the left tangent.
BoardPoseFit fit_board_pose(const std::vector<Eigen::Vector3d>& target_m,
                            std::span<const BoardView> views,
                            const Rig& rig,
                            const Pose& start,
                            int max_iterations = 10);

/// The board's mirror image in the plane through the centre of the seen corners, across the line of
/// sight, turned face to the camera: under weak perspective it projects to the same pixels
/// (Schweighofer and Pinz, Robust Pose Estimation from a Planar Target, PAMI 28, 2006).
Pose mirrored_board_pose(const std::vector<Eigen::Vector3d>& target_m,
                         const BoardView& view,
                         const Pose& T_camera_board);

/// The better of the fits to one view from a start and from its mirror image. The view is of
/// camera 0 of a rig of one camera.
BoardPoseFit fit_board_pose_both_ways(const std::vector<Eigen::Vector3d>& target_m,
                                      const BoardView& view,
                                      const Rig& one,
                                      const Pose& start,
                                      int max_iterations = 10);

/// The best fit to all views of a frame, started from each view alone and its mirror image. Throws
/// Error if no pose fits.
BoardPoseFit find_board_pose(const std::vector<Eigen::Vector3d>& target_m,
                             std::span<const BoardView> views,
                             const Rig& rig,
                             int max_iterations = 20);

}  // namespace vernier::internal
