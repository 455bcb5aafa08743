// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace vernier {

/// The corners of the target seen by one camera in one frame.
struct BoardView {
  int frame = 0;   ///< views of one frame are simultaneous
  int camera = 0;  ///< index into the rig's cameras
  std::string image;
  std::vector<int> ids;  ///< index into target_m, one per corner
  std::vector<Eigen::Vector2d> pixels_px;
};

/// Corners of a rigid target observed by the cameras of a rig.
struct BoardObservations {
  std::vector<Eigen::Vector2i> size_px;  ///< width and height of each camera's images
  std::vector<Eigen::Vector3d> target_m;
  std::vector<BoardView> views;  ///< sorted by frame, then camera
};

/// The distinct frame numbers, ascending.
std::vector<int> frames_of(const BoardObservations& observations);

/// Whether these corners of the target determine its pose: at least four, with at least two off any
/// line of the board. Collinear corners leave a rotation about the line free.
bool determines_pose(const std::vector<Eigen::Vector3d>& target_m, const std::vector<int>& ids);

/// At most `most` of the frames, evenly spaced.
std::vector<int> evenly_spaced(const std::vector<int>& frames, int most);

/// The views of the given frames (ascending).
BoardObservations at_frames(const BoardObservations& observations, const std::vector<int>& frames);

/// The corners for which `kept(view, place of the corner in it)` holds. Views whose corners then do
/// not determine the board's pose are left out.
BoardObservations with_corners(
    BoardObservations observations,
    const std::function<bool(const BoardView& view, std::size_t corner)>& kept);

/// Sorts the views by frame, then camera, and checks that they can be used for calibration: sizes
/// given, target finite, camera and corner indices in range, no camera twice in a frame and no
/// corner twice in a view, one finite pixel per corner inside the image, corners of each view that
/// determine the board's pose. Throws Error naming frame, camera and corner.
void check_and_sort(BoardObservations& observations);

}  // namespace vernier
