// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/loss.h"

namespace vernier::internal {

/// Lanes of eight packed pairs: u_left v_left u_right v_right 1/σ; 1/σ = 0 pads.
inline constexpr int packed_pair_lanes = 5;

/// A rig of two cameras in the kernels' form.
struct EpipolarView {
  CameraModel models[2];
  double f_px[2], ax[2], ox_px[2], oy_px[2], k[2][max_distortion_count];
  double R[9], t[3];

  explicit EpipolarView(const Rig& rig);
};

/// Columns of a pair's row: the parameters of the rig (calib/rig.h), then the residual.
inline int epipolar_columns(const EpipolarView& view) {
  return parameter_count(view.models[0]) + parameter_count(view.models[1]) + 7;
}

/// Adds Σ w [J r]ᵀ [J r], w = ρ'/2r, over `eights` x 8 pairs to `sums`, packed upper triangle of
/// epipolar_columns(), and returns Σ ρ(r). Lane by lane, so that sums do not depend on the register
/// width.
double sum_pairs(const EpipolarView& view,
                 const Lanes* packed,
                 std::size_t eights,
                 const Loss& loss,
                 double* sums);

/// The residuals r, `eights` x 8 of them. NaN if a pixel's ray is beyond the fold of the lens
/// model.
void pair_residuals(const EpipolarView& view,
                    const Lanes* packed,
                    std::size_t eights,
                    double* residuals);

}  // namespace vernier::internal
