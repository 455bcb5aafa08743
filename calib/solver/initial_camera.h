// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {

/// Initial estimate of one camera and of the board poses in its views.
struct InitialCamera {
  Camera camera;
  std::vector<Pose> T_camera_board;  ///< one per view
  double typical_rms_px = 0;         ///< of the better three quarters of the views, per coordinate
};

/// An initial estimate of one camera from its views of a flat target alone. The focal length comes
/// from the homographies (calib/board/board_homography.h) with the principal point at the image
/// centre; a second start uses 0.8 image widths. Poses follow by PnP. Then f and k1, with ax and
/// k2, then all parameters are improved by Gauss–Newton on the typical views (residual below five
/// times the median), with the poses eliminated. If the better start leaves more than 0.2 % of the
/// image (a wide-angle or fisheye lens, whose views are not homographies), starts from 0.25 to 3
/// image widths are tried. All `views` must be the camera's. Throws Error for fewer than three
/// views (`place`), or for a target that is not flat.
InitialCamera initial_camera(const BoardObservations& observations,
                             const std::vector<BoardView>& views,
                             const CameraModel& model,
                             const std::string& place);

}  // namespace vernier::internal
