// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/data_and_prior.h"
#include "calib/rig.h"

namespace vernier::internal {

/// The spectrum of C_0^(-1/2) C C_0^(-1/2), C_0 = `before` and C = `after` in the tangent of `rig`
/// over the parameters `names`. Throws Error if `before` is not positive definite.
Observability observability(const Rig& rig,
                            const std::vector<std::string>& names,
                            const Eigen::MatrixXd& before,
                            const Eigen::MatrixXd& after);

/// The directions of the rig's tangent that matched pairs cannot observe, one per column, from
/// their analytic form. A parameter change that leaves the distortion alone multiplies the rays of
/// a camera by a matrix, X → (I + s M) X, and changes the essential matrix E = [T]x R of X_rᵀ E X_l
/// by E M_l or M_rᵀ E. These changes are
///
///     f, ax, ox, oy             of a lens whose distortion coefficients are all zero
///     f with k1² k2⁴ p1 p2 k3⁶… of a distorted lens (the same lens at another scale); none of
///     `fisheye4`
///
/// and the six of the pose. Unobservable is every combination that keeps E up to scale, the scale T
/// → s T always; for a scene on the plane n·X = 1 (left frame, n in 1/m) every one that changes E
/// to H⁻ᵀ [v]x for some v, H = R + T nᵀ the plane's homography.
Eigen::MatrixXd unobservable_directions(const Rig& rig,
                                        const std::optional<Eigen::Vector3d>& plane = {});

}  // namespace vernier::internal
