// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// One flag a parameter of the rig. Throws Error for a name that the rig does not have, for a
/// parameter held twice and for values that no camera has (f_px or ax not above 0, not finite).
std::vector<bool> held_mask(const Rig& rig, const std::vector<HeldParameter>& held);

/// The rig with the held parameters at their values, or at what stands for none (above).
Rig with_held_values(const Rig& rig, const std::vector<HeldParameter>& held);

/// The directions of the rig's tangent that are left free, parameters x free parameters: unit
/// vectors for intrinsics and positions; for a rotation the columns of J_l(r) (calib/pose.h) that
/// belong to the free components of its rotation vector r.
Eigen::MatrixXd free_directions(const Rig& rig, const std::vector<bool>& held);

/// The derivative of the rig's tangent by the parameters' values, J_l for a rotation that is held
/// in part (its rotation vector is its value) and the identity for all else, and its inverse:
/// parameters x parameters. The free directions are columns of the first.
Eigen::MatrixXd tangent_by_values(const Rig& rig, const std::vector<bool>& held);
Eigen::MatrixXd values_by_tangent(const Rig& rig, const std::vector<bool>& held);

/// A covariance C of the tangent, zero along what is held, as one of the free parameters' values:
/// C_z with C = E C_z Eᵀ, E the free directions.
Eigen::MatrixXd covariance_of_free(const Eigen::MatrixXd& C,
                                   const Rig& rig,
                                   const std::vector<bool>& held);

/// One flag a parameter that a covariance C of the tangent gives no variance; a component of a
/// rotation has it as one of the rotation vector.
std::vector<bool> without_variance(const Rig& rig, const Eigen::MatrixXd& C);

/// Names of the parameters that are not held.
std::vector<std::string> free_names(const Rig& rig, const std::vector<bool>& held);

/// The parameters that `prior` does not name, held at the values of its rig.
std::vector<HeldParameter> held_by(const GaussianRigPrior& prior);

}  // namespace vernier::internal
