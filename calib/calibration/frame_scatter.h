// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"

namespace vernier::internal {

/// Parameters of one camera that a rigid rig keeps from frame to frame.
enum class Kept {
  pose,  ///< its pose in the rig
  lens   ///< its focal length and principal point; of a split, all its intrinsics
};

/// What freeing such parameters would explain of a solution's squared residuals.
struct FrameScatter {
  Kept kept = Kept::pose;
  int camera = 0;
  bool is_split = false;   ///< one change, after frame `last_frame`; else anew in each frame
  int last_frame = 0;      ///< of a split: the last before the change
  int frames = 0;          ///< that show it
  double share = 0;        ///< of Σ r², beyond what as many parameters explain of white noise
  double f_ratio = 0;      ///< Σ r² explained per parameter over the rest per degree of freedom
  double shift_px = 0;     ///< rms displacement of the camera's image that this is equal to
  int worst_frame = 0;     ///< the frame that explains most
  double worst_share = 0;  ///< its part of Σ r²
};

/// Score tests, without solving anew, of the hypotheses that one camera's pose or lens is not the
/// same in all frames: Σ g_fᵀ H_f⁻¹ g_f over the frames, g_f and H_f a frame's score and
/// information with its board's pose eliminated (calib/solver/normal_equations.h); and for a single
/// change, g_2ᵀ (S_2 − S_2 S⁻¹ S_2)⁻¹ g_2 at the best place, S_2 and g_2 those of the frames after
/// it (Andrews, "Tests for parameter instability and structural change with unknown change point",
/// Econometrica 1993). `state` is a minimum without prior or held parameters. Empty if there are
/// fewer than four frames.
std::vector<FrameScatter> frame_scatter(const BoardObservations& observations,
                                        const BoardState& state);

/// The same of matched pairs, the image pairs being the frames: those of 12 matches or more, if
/// there are four. `rig` may be a minimum with a prior: what another rig for all of them explains
/// is taken off first, to first order, so that a prior that conflicts is no change. `pairs` are the
/// inliers, with their stated noise.
std::vector<FrameScatter> frame_scatter(const PairObservations& pairs, const Rig& rig);

}  // namespace vernier::internal
