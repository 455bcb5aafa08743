// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

/// A pose of a board in front of a rig.
struct BoardPlacement {
  Eigen::Vector2d centre_px;  ///< of the board's centre, in the image of the first camera that must
                              ///< see it
  double distance_m = 0;      ///< from that camera to the board's centre
  double turn_rad = 0;        ///< about the image's vertical; above 0 the right edge is nearer
  double tilt_rad = 0;        ///< about the image's horizontal; above 0 the upper edge is nearer
  Pose T_first_board;
  std::array<int, 5> step{};  ///< in the grid of placements: column, row, fill, turn, tilt
};

/// Which placements are considered.
struct PlacementOptions {
  std::vector<int> cameras;  ///< that must see the board, the first the reference; empty: all
  int places = 5;            ///< of the centre along each side of the reference's image
  int fills = 5;             ///< steps of the size
  double min_fill = 0.25;    ///< size of the fronto-parallel board over the image's width or height
  double greatest_fill = 0.95;
  int angles = 5;  ///< steps of turn and of tilt
  double greatest_angle_rad = std::numbers::pi / 4;
  double greatest_slant_rad = std::numbers::pi / 3;  ///< between its normal and the line of sight
  double border_px = 5;  ///< minimum distance of corners from the image's edge
  bool partly = false;   ///< one of several cameras may see only a quarter of the corners
};

/// A placement with the corners that each camera sees (noise-free, frame 0).
struct PlacedBoard {
  BoardPlacement placement;
  std::vector<BoardView> views;
};

/// All placements of the target that the cameras of the options see completely (except with
/// `partly`), in an order that depends only on the options; views of other cameras that see it
/// completely are added. `target_m` is near the plane z = 0, x right and y down; a fronto-parallel
/// board has its axes along the reference camera's. Throws Error if there is
/// none.
std::vector<PlacedBoard> placed_boards(const Rig& rig,
                                       const std::vector<Eigen::Vector3d>& target_m,
                                       const PlacementOptions& options = {});

/// "hold the board 0.55 m away, its centre in the upper right of the left image (480, 120), turned
/// 35° about the vertical axis (right edge nearer), tilted 0°"
std::string describe_placement(const BoardPlacement& placement, const Camera& reference);

}  // namespace vernier::internal
