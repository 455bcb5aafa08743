// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// Which checks are applicable.
struct ViewCheckOptions {
  /// Intrinsics are estimated from the views. Set to false if they are held or given by a prior.
  bool tilts = true;
};

/// Checks the views at an initial state (initial_state): whether all frames agree on the relative
/// poses of the cameras. A frame fits if one board pose explains both its images
/// (PairConsensus::fits, calib/calibration/view_pair.h); the pose between the cameras is the
/// consensus of the frames. A frame that does not fit is tried with one image's corners in reverse
/// order, and with its images exchanged.
///
/// Throws Error, naming frames, camera and images, if a repair proves the fault:
///
///  - corners numbered half a turn apart, in some frames or in all;
///  - left and right exchanged in some frames;
///  - two frames that each have the other's second image;
///  - images paired wrongly throughout: they fit when one camera's are shifted by some frames;
///  - the images of one camera mirrored: most frames agree if they are mirrored back;
///  - most frames agree on no pose at all (not simultaneous, or the cameras moved);
///  - boards whose tilts leave the intrinsics undetermined (check_tilts,
///  calib/calibration/tilt_check.h).
///
/// Doubts of frames: gross errors (1.5 % of the image) under every reading. Trust warnings: in a
/// pair, the second camera to the left of the first, or both at the same position.
ObservationDiagnosis check_views(const BoardObservations& observations,
                                 const BoardState& start,
                                 const ViewCheckOptions& options = {});

/// Those frames that no doubt is about.
std::vector<int> frames_without(const std::vector<FrameDoubt>& doubts,
                                const std::vector<int>& frames);

/// The texts of those doubts that the solution does not refute: it refutes them if no corner of the
/// frame is an outlier and the residuals of its views are as small as those of the others (median
/// length at most twice the median of the views). Where the start was bad, sound frames seem wrong
/// there.
std::vector<std::string> unrefuted(const std::vector<FrameDoubt>& doubts,
                                   const BoardObservations& inliers,
                                   const BoardState& state,
                                   const std::vector<CornerOutlier>& outliers);

}  // namespace vernier::internal
