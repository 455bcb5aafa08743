// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/board_observations.h"

namespace vernier::internal {

/// A frame that seems wrong at an approximate start.
struct FrameDoubt {
  int frame = 0;
  std::string text;  ///< as a trust warning
};

/// Findings about observations that do not prove them wrong.
struct ObservationDiagnosis {
  std::vector<std::string> warnings;        ///< for information; the result is valid
  std::vector<std::string> trust_warnings;  ///< the result may be wrong, and what to do
  std::vector<FrameDoubt> frame_doubts;     ///< trust warnings, unless the solution refutes them

  void add(const ObservationDiagnosis& more);
};

/// Checks corners before solving, with one homography per view (no camera model needed). Call
/// check_and_sort first. Throws Error, naming frame, camera and image, for
///
///  - corners that are not on a plane (rows and columns exchanged, wrong numbering) in more than a
///    fifth of a camera's views; in fewer the frame is doubted. Residual of the homography above
///    half the spacing of corners, and more than 15 % of the corners off a homography with their
///    eight neighbours by a quarter of the spacing, since a wide lens bends the board as a whole;
///  - some views mirrored relative to the others: determinant of the homography of opposite sign;
///  - a repeated view: corners of two frames of a camera within 0.001 px;
///  - identical left and right images: corners of two cameras in a frame within 0.05 px.
///
/// Trust warnings: every view of a chessboard mirrored; almost no corner beyond half the image
/// (wrong size). Warnings: frames seen by some cameras only, repeated views (rms below 0.3 px), a
/// board of unlikely size.
///
/// `may_leave_out`: false if wrong corners are kept; then no view may be off a plane.
ObservationDiagnosis check_observations(const BoardObservations& observations,
                                        bool may_leave_out = true);

/// "frame 3, camera 1 (right03.png)".
std::string view_label(const BoardView& view);

/// "3, 5 and 9"; of a long list the first few and the number of the rest.
std::string list_of(const std::vector<std::string>& names);

}  // namespace vernier::internal
