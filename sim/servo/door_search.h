// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/servo/goal_alignment.h"
#include "sim/servo/stereo_line.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// All lines of a view that stereo can place.
std::vector<SeenLine> see_all(const Rig& told, std::span<const stereo::StereoSegment> segments);

/// For each desired line, predicted where its images should be, the nearest line of the view within
/// `gate_px` in either image; long lines are preferred to pieces.
std::vector<LineMatch> nearest_lines(const DesiredView& desired,
                                     std::span<const StereoLine> predicted,
                                     std::span<const SeenLine> seen,
                                     double gate_px);

/// Where the desired lines would be if the goal was there, in the robot's frame.
std::vector<SpaceLine> lines_at(const DesiredView& desired, const localise::Pose2D& goal);
std::vector<StereoLine> images_of(std::span<const SpaceLine> lines, const Pose& T_right_left);

/// Poses of the robot in the goal's frame among which it may be.
struct SearchRange {
  double nearest_back_m, farthest_back_m, aside_m, turned_rad;
};

/// Finds the desired lines in a view from somewhere in the range: every pose of a lattice is scored
/// by how many lines would have a line of the view beside them in both images, and the best ones
/// are aligned. The result is the best of these: the goal in the robot's frame. Nothing if fewer
/// than four lines agree.
std::optional<localise::Pose2D> find_goal(const DesiredView& desired,
                                          std::span<const SeenLine> seen,
                                          const SearchRange& range);

}  // namespace vernier::sim::internal
