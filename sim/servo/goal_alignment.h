// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/servo/stereo_line.h"

namespace vernier::sim::internal {

/// Lines that the robot sees where it should stand, in the frame of the left camera there, with the
/// rig it is told and how the rig is mounted.
struct DesiredView {
  std::vector<SeenLine> lines;
  Pose T_right_left;
  localise::CameraMount mount;
  double focal_px = 1;  ///< of the left camera
};

/// A line of the desired view and the same line as it is seen now.
struct LineMatch {
  int line = 0;  ///< of DesiredView::lines
  SeenLine seen;
};

struct GoalFix {
  localise::Pose2D goal;        ///< where the robot should stand, in its own frame
  std::vector<double> weights;  ///< one per match, 0 of outliers
  double image_error_px = 0;    ///< root mean square of rho, seen minus desired, of the weighted
  double unexplained_px = 0;    ///< what is left of it that no motion on the floor explains
  int inliers = 0;
};

/// Maps the image error e = s - s* of the matches to the motion on the floor that removes it,
///
///     motion = -(LᵀWL)⁻¹ LᵀW e,   L = (L(now) + L(goal)) / 2,
///
/// with depths from stereo: the mean of both interaction matrices is exact to second order (Malis,
/// "Improving vision-based control using efficient second-order minimization techniques", ICRA
/// 2004). W: Tukey's weights with a scale from the median (Comport, Marchand and Chaumette,
/// "Statistically robust 2-D visual servoing", IEEE Trans. Robotics 22(2), 2006), so that false
/// matches do not steer. At e = 0 the motion is 0 whatever the depths are. Nothing with fewer than
/// four inliers.
std::optional<GoalFix> goal_by_image_error(const DesiredView& desired,
                                           std::span<const LineMatch> matches);

/// The place of the goal for which the desired lines, moved there, have the images that are seen:
/// Gauss and Newton's steps from `start` (virtual visual servoing: Marchand and Chaumette, Computer
/// Graphics Forum 21(3), 2002), with the same weights. It finds the door before the robot moves.
std::optional<GoalFix> align_goal(const DesiredView& desired,
                                  std::span<const LineMatch> matches,
                                  const localise::Pose2D& start);

}  // namespace vernier::sim::internal
