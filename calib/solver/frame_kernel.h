// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/rig.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {

/// One double a lane, aligned as the widest registers like it.
struct alignas(64) Lanes {
  double of[kernel_lanes] = {};
};

/// Where a camera's parameters stand in the rig's, and how the twist of the board moves it:
///
///     twist of T_camera_board = Ad twist of T_first_board + twist of T_camera_first
///     Ad = [R 0; [t]x R  R],   R, t of T_camera_first
struct CameraTransform {
  int intrinsics = 0;  ///< index of f_x
  int count = 0;       ///< of intrinsics
  int pose = -1;       ///< index of the twist of T_camera_first; the first camera has none
  int warp = -1;       ///< index of the board's warp where that is free
  double R[9] = {}, tR[9] = {};
};

/// The warp, where free, stands after the rig's parameters.
std::vector<CameraTransform> camera_transforms(const Rig& rig, bool warp);

/// Sums over frames of the normal equations reduced to the rig, eight lanes each (add them up).
struct ReducedSums {
  std::vector<Lanes> information;  ///< packed upper triangle: S = Σ AᵀA - Zᵀ Z, Z = L⁻¹ BᵀA
  std::vector<Lanes> gradient;     ///< Σ Aᵀr - Zᵀ y,                          y = L⁻¹ Bᵀr
  std::vector<Lanes> diagonal;     ///< of Σ AᵀA
  Lanes chi2;                      ///< Σ r²
  Lanes frames_drop;               ///< Σ yᵀ y, the fall of χ² by the board poses alone

  explicit ReducedSums(int parameters)
      : information(packed_size(parameters)), gradient(parameters), diagonal(parameters) {}
};

/// Lanes that eliminate_frames() keeps of eight frames for the way back: L (21, its diagonal
/// inverted), y (6), Z (6 a parameter).
inline std::size_t frame_factor_size(int parameters) {
  return static_cast<std::size_t>(27 + 6 * parameters);
}

/// Eliminates the board's pose from eight frames. `sums[c]` is what sum_views() made of camera c,
/// or null where no lane sees the board; `absent` is 1 in a lane without a frame, else 0. The
/// diagonal of BᵀB is multiplied by 1 + damping. Derivatives are by the intrinsics
/// (f_x f_y o_x o_y k …), the twists of T_camera_first and the warp.
void eliminate_frames(const std::vector<CameraTransform>& places,
                      const std::vector<const double*>& sums,
                      const Lanes& absent,
                      double damping,
                      Lanes* factor,
                      ReducedSums& total);

/// The way back: the twists of eight board poses, x = -L⁻ᵀ (y + Z step), for a step of the rig's
/// parameters.
void frame_steps(const Lanes* factor, const Eigen::VectorXd& step, Lanes (&twists)[6]);

}  // namespace vernier::internal
