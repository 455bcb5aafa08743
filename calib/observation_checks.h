// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/board_observations.h"

namespace vernier {

/// What a check of observations has to say that is no proof against them.
struct ObservationDiagnosis {
  std::vector<std::string> warnings;  ///< good to know; the result stands
  std::vector<std::string> doubts;    ///< the result may be wrong, and what to do

  void add(const ObservationDiagnosis& more);
};

/// What may be asked of the observations.
struct ObservationCheckOptions {
  /// Intrinsics are to be estimated, which takes three tilts of the board a camera. Switch it off
  /// where they are held or where a prior brings them.
  bool tilts = true;
};

/// Looks at corners before anything is solved, by one homography a view (no camera model needed).
/// Call check_and_sort first. Throws Error, naming frame, camera and image, for
///
///  - corners that lie on no plane: residual of the homography above half the spacing of corners
///    (rows and columns exchanged, wrong numbering);
///  - some views mirrored against the others: the homography's determinant has the other sign;
///  - one view twice: corners of two frames of a camera within 0.001 px;
///  - left and right images the same: corners of two cameras in a frame within 0.05 px;
///  - boards all parallel to the image, or at fewer than three tilts (see distinct_tilts).
///
/// Doubts: every view mirrored; nearly no corner beyond half the image (wrong size). Warnings:
/// frames seen by some cameras only, repeated views (rms below 0.3 px), a board of unlikely size.
ObservationDiagnosis check_observations(const BoardObservations& observations,
                                        const ObservationCheckOptions& options = {});

/// The views' plane normals counted as distinct: a normal is new where it stands at least
/// `apart_rad` from all counted before it.
int distinct_tilts(const std::vector<Eigen::Vector3d>& normals, double apart_rad = 0.05);

/// Throws Error (`place`) where the boards' unit normals, in the camera's frame and away from it,
/// leave the intrinsics undetermined: all within 0.07 rad of the optical axis, or fewer than three
/// distinct tilts.
void check_tilts(const std::vector<Eigen::Vector3d>& normals, const std::string& place);

/// "frame 3, camera 1 (right03.png)".
std::string place_of(const BoardView& view);

}  // namespace vernier
