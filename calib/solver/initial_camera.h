// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {

/// A first guess of one camera and of where the board stood in its views.
struct InitialCamera {
  Camera camera;
  std::vector<Pose> T_camera_board;  ///< one a view
  double typical_rms_px = 0;         ///< of the better three quarters of the views, a coordinate
};

/// A start for one camera from its views of a flat target alone. The focal length comes from the
/// homographies (calib/board/board_homography.h) with the centre in the middle of the image, and in
/// a second start is 0.8 image widths; poses follow by PnP; then f and k1, with ax and k2, then all
/// parameters are improved by Gauss and Newton's method on the typical views (residual below five
/// times that of most), the poses following. Where the better start leaves more than 0.2 % of the
/// image (a wide-angle or fisheye lens, whose views are no homographies), starts from 0.25 to 3
/// image widths are tried. Of `views` all must be the camera's own. Throws Error with fewer than
/// three views (`place`), or for a target that is not flat.
InitialCamera initial_camera(const BoardObservations& observations,
                             const std::vector<BoardView>& views,
                             const CameraModel& model,
                             const std::string& place);

}  // namespace vernier::internal
