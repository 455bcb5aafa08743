// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/rig.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {

/// One double per lane, aligned for the widest registers.
struct alignas(64) Lanes {
  double of[kernel_lanes] = {};
};

/// Indices of a camera's parameters in the rig's, and how the twist of the board moves it:
///
///     twist of T_camera_board = Ad twist of T_first_board + twist of T_camera_first
///     Ad = [R 0; [t]x R  R],   R, t of T_camera_first
struct CameraTransform {
  int intrinsics = 0;  ///< index of f_x
  int count = 0;       ///< of intrinsics
  int pose = -1;       ///< index of the twist of T_camera_first; -1 for the first camera
  int warp = -1;       ///< index of the board's warp if it is free
  double R[9] = {}, tR[9] = {};
};

/// A free warp comes after the rig's parameters.
std::vector<CameraTransform> camera_transforms(const Rig& rig, bool warp);

/// Sums over frames of the normal equations reduced to the rig, in eight lanes each (to be added).
struct ReducedSums {
  std::vector<Lanes> information;  ///< packed upper triangle: S = Σ AᵀA - Zᵀ Z, Z = L⁻¹ BᵀA
  std::vector<Lanes> gradient;     ///< Σ Aᵀr - Zᵀ y,                          y = L⁻¹ Bᵀr
  std::vector<Lanes> diagonal;     ///< of Σ AᵀA
  Lanes chi2;                      ///< Σ r²
  Lanes frames_drop;               ///< Σ yᵀ y, the decrease of χ² due to the board poses alone

  explicit ReducedSums(int parameters)
      : information(packed_size(parameters)), gradient(parameters), diagonal(parameters) {}
};

/// Number of lanes that eliminate_frames() stores for eight frames for the back-substitution: L
/// (21, with inverted diagonal), y (6), Z (6 per parameter).
inline std::size_t frame_factor_size(int parameters) {
  return 27 + 6 * static_cast<std::size_t>(parameters);
}

/// Eliminates the board's pose from eight frames. `sums[c]` is the result of sum_views() for camera
/// c, or null if no lane sees the board; `absent` is 1 in a lane without a frame, else 0. The
/// diagonal of BᵀB is multiplied by 1 + damping. Derivatives are with respect to the intrinsics
/// (f_x f_y o_x o_y k …), the twists of T_camera_first and the warp.
void eliminate_frames(const std::vector<CameraTransform>& places,
                      const std::vector<const double*>& sums,
                      const Lanes& absent,
                      double damping,
                      Lanes* factor,
                      ReducedSums& total);

/// Back-substitution: the twists of eight board poses, x = -L⁻ᵀ (y + Z step), for a step of the
/// rig's parameters.
void frame_steps(const Lanes* factor, const Eigen::VectorXd& step, Lanes (&twists)[6]);

}  // namespace vernier::internal
