// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/camera.h"

namespace vernier::internal {

/// Views are processed eight at a time, one per SIMD lane: sums over corners need no sums over
/// lanes, and their order does not depend on the register width.
inline constexpr int kernel_lanes = 8;

/// Doubles per corner in the packed target (X, Y, Z, 1/σ, and two warp shapes) and in the packed
/// pixels (u, v), eight lanes each.
inline constexpr int target_stride(bool warp) { return (warp ? 6 : 4) * kernel_lanes; }
inline constexpr int pixel_stride = 2 * kernel_lanes;

/// Columns of a view's system: f_x f_y o_x o_y k1 …, twist (6), warp (2 if free), residual.
inline int view_columns(const CameraModel& model, bool warp) {
  return parameter_count(model) + (warp ? 9 : 7);
}

/// Index of element (i, j), i <= j, in a packed upper triangle of n columns.
inline constexpr std::size_t packed_index(int i, int j, int n) {
  return static_cast<std::size_t>(i * (2 * n - i - 1) / 2 + j);
}
inline constexpr std::size_t packed_size(int n) {
  const auto size = static_cast<std::size_t>(n);
  return size * (size + 1) / 2;
}

/// Eight views of one camera.
struct ViewLanes {
  const CameraModel* model;
  const double* intrinsics;  ///< f_x f_y o_x o_y k1 …
  const double* pose;        ///< T_camera_board: R row by row, t; 12 x 8 lanes
  const double* target;      ///< corners x target_stride
  const double* pixels;      ///< corners x pixel_stride
  int corners;               ///< of the view with most; others are padded with weight 0
  bool warp;                 ///< whether the columns of the warp are computed
  double warp_m[2];          ///< the warp if `warp` is set, else 0: the target includes it
};

/// The normal equations [J r]ᵀ [J r] of eight views, packed upper triangle of view_columns() by
/// eight lanes: `sums` has packed_size(view_columns()) x 8 elements and is overwritten.
void sum_views(const ViewLanes& views, double* sums);

/// Σ r² of each of the eight views.
void sum_residuals(const ViewLanes& views, double* chi2);

/// The upper triangular factor U of each view's system, sums = UᵀU, in place: as many rows as
/// columns replace all corners of the view with the same cost, gradient and Gauss–Newton matrix. A
/// column that depends on those before it up to rounding gets a row of zeros.
void factor_views(int columns, double* sums);

}  // namespace vernier::internal
