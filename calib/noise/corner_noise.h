// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// Standard deviations of what makes the corners of a board differ from their prediction. With D_f
/// the derivatives of a frame's corners with respect to the points of the board, M_f with respect
/// to a motion of the board about its centre between the exposure of the first camera and of
/// another one, and K the correlation exp(−d² / 2 ℓ²) of two corners a distance d apart on the
/// board,
///
///     V_f = w² I + g² (I_cameras ⊗ K ⊗ I₂) + M_f diag(s_r² I₃, s_b², s_t² I₂) M_fᵀ    in each
///     frame
///     + D_f diag(b², b², h²) D_gᵀ                                           between all frames f,
///     g
///
/// s_b is along the baseline, from the first camera to the other, which changes all disparities of
/// a board alike; s_t along the two axes across it; s_b = s_t if the motion is isotropic. The last
/// is the fixed uneven shape of the board, the same in all frames.
struct CornerNoise {
  double white_px = 0;           ///< w, each coordinate on its own
  double field_px = 0;           ///< g, a smooth error over the board, anew in each image
  double field_length_m = 0;     ///< ℓ, on the board
  double motion_rad = 0;         ///< s_r, about each axis
  double motion_m = 0;           ///< s_t, along each axis
  double motion_baseline_m = 0;  ///< s_b, along the baseline; 0: s_t
  double shape_plane_m = 0;      ///< b, of a corner along x and y of the board
  double shape_height_m = 0;     ///< h, of a corner along z of the board
};

/// Standard deviations of the motion in the order of the columns of M (calib/noise/frame_rows.h):
/// rotations, along the baseline, across it; again for each further camera.
Eigen::VectorXd motion_sigmas(const CornerNoise& noise, Eigen::Index columns);

/// Which of them there are; white noise always.
struct NoiseParts {
  bool field = true;
  bool motion = true;  ///< false: the cameras are synchronised, or the board stood still
  bool shape = false;
  bool baseline_motion = false;  ///< s_b is not s_t; only with motion
};

/// The components of a calibration's random effects.
CornerNoise noise_of(const CalibrationEffects& effects);

/// The least distance between two points of the target: a square of a chessboard. Throws Error for
/// fewer than two points, or two in one place.
double point_spacing_m(const std::vector<Eigen::Vector3d>& target_m);

}  // namespace vernier::internal
