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
/// over the parameters `names`. Throws Error where `before` is not positive definite.
Observability observability(const Rig& rig,
                            const std::vector<std::string>& names,
                            const Eigen::MatrixXd& before,
                            const Eigen::MatrixXd& after);

/// The directions of the rig's tangent that matched pairs cannot see, one a column, from their
/// analytic form. A change of a parameter that leaves the distortion alone moves the rays of a
/// camera by a matrix M, X → (I + s M) X, and the essential matrix E = [T]x R of X_rᵀ E X_l by
/// E M_l or M_rᵀ E. Such are
///
///     f, ax, ox, oy             of a lens whose distortion coefficients are all zero
///     f with k1² k2⁴ p1 p2 k3⁶… of a distorted one (the same lens at another scale), `fisheye4`
///     none
///
/// and the six of the pose. Unseen is every combination that leaves E alone up to its scale, the
/// scale T → s T always; of a scene that is the plane n·X = 1 (left frame, n in 1/m) every one that
/// takes E to H⁻ᵀ [v]x with some v, H = R + T nᵀ the plane's homography.
Eigen::MatrixXd unobservable_directions(const Rig& rig,
                                        const std::optional<Eigen::Vector3d>& plane = {});

}  // namespace vernier::internal
