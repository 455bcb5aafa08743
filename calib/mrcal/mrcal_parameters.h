// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/rig.h"

namespace vernier::internal {

/// The rig's parameters in mrcal's parametrisation, in the order of calib/rig.h:
///
///     fx = f ax,  fy = f,  cx = ox,  cy = oy,  k…        a camera
///     r = Log R (additive, not a left perturbation),  t   a camera but the first
///
/// radial1 is mrcal's OPENCV4 with k2 = p1 = p2 = 0 locked, and those three are not listed.
Eigen::VectorXd mrcal_parameters(const Rig& rig);

/// left.fx left.fy left.cx left.cy left.k1 … right.rx right.ry right.rz right.tx …
std::vector<std::string> mrcal_parameter_names(const Rig& rig);

/// The rig with mrcal's parameters; names, sizes and models from `like`.
Rig rig_from_mrcal(const Rig& like, const Eigen::VectorXd& parameters);

/// G = d mrcal_parameters / d tangent: dfx = ax df + f dax, and δr = J_l(r)⁻¹ w maps the left
/// tangent to the additive rotation vector. A covariance C of ours is G C Gᵀ in mrcal's parameters.
Eigen::MatrixXd mrcal_by_tangent(const Rig& rig);

/// The estimated parameters among all those of mrcal's lens model. mrcal can only lock the core or
/// the distortion as a whole; single parameters are locked or tied by columns,
///
///     b = c + L a,   b all that mrcal has, a the free ones
///
/// so that J L is the Jacobian of the smaller problem.
struct MrcalLift {
  Eigen::MatrixXd L;       ///< mrcal's states of the rig x free parameters
  std::vector<int> shown;  ///< the states that mrcal_parameters lists, in its order
  bool native = true;      ///< nothing is locked or tied: mrcal's own solver does it
};

/// `held` has one entry per parameter of ours; empty: none held. A held ax ties fx to fy; a
/// component of a rotation is held as that component of the rotation vector.
MrcalLift mrcal_lift(const Rig& rig, const std::vector<bool>& held = {});

/// mrcal's lens model for a rig. All cameras of a problem in mrcal have the same model; the models
/// supported by both programs are nested, so it is the largest among the cameras'.
struct MrcalLens {
  std::string name;  ///< such as LENSMODEL_OPENCV4
  int parameters = 0;
};

/// Throws Error for a model that mrcal does not have, such as fisheye4.
MrcalLens mrcal_lens(const Rig& rig);

}  // namespace vernier::internal
