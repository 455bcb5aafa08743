// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/board_observations.h"

namespace vernier::internal {

/// What a check of observations has to say that is no proof against them.
struct ObservationDiagnosis {
  std::vector<std::string> warnings;        ///< good to know; the result stands
  std::vector<std::string> trust_warnings;  ///< the result may be wrong, and what to do

  void add(const ObservationDiagnosis& more);
};

/// Looks at corners before anything is solved, by one homography a view (no camera model needed).
/// Call check_and_sort first. Throws Error, naming frame, camera and image, for
///
///  - corners that lie on no plane: residual of the homography above half the spacing of corners
///    (rows and columns exchanged, wrong numbering);
///  - some views mirrored against the others: the homography's determinant has the other sign;
///  - one view twice: corners of two frames of a camera within 0.001 px;
///  - left and right images the same: corners of two cameras in a frame within 0.05 px.
///
/// Doubts: every view of a chessboard mirrored; nearly no corner beyond half the image (wrong
/// size). Warnings: frames seen by some cameras only, repeated views (rms below 0.3 px), a board of
/// unlikely size.
ObservationDiagnosis check_observations(const BoardObservations& observations);

/// "frame 3, camera 1 (right03.png)".
std::string view_label(const BoardView& view);

/// "3, 5 and 9"; of many the first few and how many more.
std::string list_of(const std::vector<std::string>& names);

}  // namespace vernier::internal
