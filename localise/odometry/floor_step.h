// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry.h"
#include "localise/odometry/step_consensus.h"
#include "localise/odometry/step_refinement.h"
#include "localise/place.h"

namespace vernier::localise::internal {

/// Two views of a robot on the floor: the rigs as they are believed to be, and how they were
/// mounted. Between them there are three degrees of freedom: x, y and heading.
struct FloorViews {
  StepRigs rigs;
  CameraMount from, to;
};

/// The motion of the left camera when the robot moves by `step`, in its first frame.
Pose camera_motion(const FloorViews& views, const Pose2D& step);
/// Its inverse, of a motion on the floor.
Pose2D robot_step(const FloorViews& views, const Pose& T_from_to);
/// x, y and heading of the robot as changes of the camera's motion.
FloorBasis floor_basis(const FloorViews& views);

/// The links whose two points are equally high above the floor, within the gate of one degree of
/// freedom.
std::vector<TriangulatedLink> level_links(const FloorViews& views,
                                          std::vector<TriangulatedLink> links,
                                          double gate_probability);

/// The motion on the floor on which most links agree, of those that two of them determine: two
/// points give the turn by the direction from one to the other, and then the shift.
std::optional<AgreedMotion> floor_consensus(const FloorViews& views,
                                            const std::vector<TriangulatedLink>& links,
                                            const StepOptions& options);

/// A step on the floor that links agree on.
struct FloorStep {
  Pose2D to_in_from;
  /// Of x, y, heading (m, rad), from the noise of the corners.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int agreeing = 0;
  double support = 0;  ///< sum of 1 - d² / gate over them
};

/// Refines a motion on the floor on the pixels of all links that agree with it (settled_step);
/// std::nullopt if fewer than min_inliers do.
std::optional<FloorStep> floor_step(const FloorViews& views,
                                    const std::vector<TriangulatedLink>& links,
                                    const Pose& start,
                                    const StepOptions& options);

}  // namespace vernier::localise::internal
