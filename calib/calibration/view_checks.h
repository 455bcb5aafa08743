// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"

namespace vernier::internal {

/// What may be asked of the views.
struct ViewCheckOptions {
  /// Intrinsics are to be estimated from the views. Switch it off where they are held or where a
  /// prior brings them.
  bool tilts = true;
};

/// Looks at the views with a start in hand (initial_state) before it is improved: do all frames
/// agree on where the cameras stand to each other? A frame fits where one board pose explains both
/// its images (PairConsensus::fits, calib/calibration/view_pair.h); the pose between the cameras is
/// the consensus of the frames. A frame that does not fit is tried with one image's corners
/// numbered from the other end, and with its images exchanged.
///
/// Throws Error, naming frames, camera and images, where a repair proves the fault:
///
///  - corners numbered half a turn apart, in some frames or in all;
///  - left and right exchanged in some frames;
///  - images paired wrongly throughout: they fit when one camera's are shifted by some frames;
///  - most frames agree on no pose at all (not simultaneous, or the cameras moved);
///  - boards whose tilts leave the intrinsics undetermined (check_tilts,
///  calib/calibration/tilt_check.h).
///
/// Doubts: frames that are grossly off (1.5 % of the image) whichever way; in a pair, the second
/// camera standing to the left of the first, or both at one place.
ObservationDiagnosis check_views(const BoardObservations& observations,
                                 const BoardState& start,
                                 const ViewCheckOptions& options = {});

}  // namespace vernier::internal
