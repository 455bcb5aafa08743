// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "calib/board_state.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

/// The kind of board poses that someone holds, as six independent coordinates: the logarithm of the
/// depth z of the board's middle, its direction x/z and y/z, and the rotation vector of the board,
/// all in the frame of one camera that sees it.
using PoseCoordinates = std::array<double, 6>;
struct PosePopulation {
  PoseCoordinates mean{}, sd{};
  int poses = 0;  ///< that it was measured from
};

/// Means and standard deviations over poses. Throws Error for fewer than three.
PosePopulation pose_population(const std::vector<Pose>& T_camera_board,
                               const std::vector<Eigen::Vector3d>& target_m);

/// Another population that could have shown these poses: each mean and standard deviation drawn
/// from its sampling distribution (Student's, χ²), so that few poses say little.
PosePopulation redrawn(const PosePopulation& population, std::uint64_t seed, std::uint32_t number);

/// Views of a population, as the information S_f (calib/solver/normal_equations.h) that each has on
/// the rig at a noise of 1 px, its board's pose eliminated; parameters x parameters. The board is
/// seen by `cameras` (at least one), and the population is that of the first of them. Coordinates
/// are uniform; a pose that one of these cameras does not see whole is drawn again, and the spread
/// that this costs is given back, so that the poses taken have the population's standard
/// deviations. Throws Error if hardly any pose is seen whole.
std::vector<Eigen::MatrixXd> population_views(const Rig& rig,
                                              const std::vector<Eigen::Vector3d>& target_m,
                                              const Eigen::Vector2d& warp_m,
                                              const PosePopulation& population,
                                              const std::vector<int>& cameras,
                                              int count,
                                              std::uint64_t seed,
                                              std::uint32_t number);

}  // namespace vernier::internal
