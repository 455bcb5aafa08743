// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/rig.h"

namespace vernier {

namespace internal {
class StableCoordinates;
}  // namespace internal

/// A Gaussian prior of some or all parameters of a rig: the first term of the unified cost (Tina
/// Memo 2017-001, Eq. 1),
///
///     χ²_prior(a) = δᵀ P δ,   δ = difference(a, mean)
///
/// with rotations in the left tangent about the mean's. If the prior is the result of a calibration
/// and knows all parameters, δ are the coordinates in which its errors are closest to normal
/// (calib/estimate/stable_coordinates.h); to first order they are the same.
struct RigPrior {
  Rig mean;
  Eigen::MatrixXd information;  ///< P, parameters x parameters; zero for unknown parameters
  std::shared_ptr<const vernier::internal::StableCoordinates> coordinates;  ///< null: the tangent
};

/// A prior from another source: `covariance` is over the parameters it names, any subset of those
/// of `rig`; the other values of `rig` are ignored. For a whole rotation it is in the left tangent;
/// for a part of one it is of these components of the rotation vector, like held ones
/// (HeldParameter), and does not constrain the others.
struct GaussianRigPrior {
  Rig rig;
  Covariance covariance;
};

/// Its covariance over all parameters of its rig, in the tangent: zero for those it does not name.
Covariance full_covariance(const GaussianRigPrior& known);

/// The same as a prior for a rig like `like`, whose models may differ (the named parameters must
/// exist). Throws Error if the covariance is not symmetric or not positive semi-definite, naming
/// the direction, and if it is singular: a direction known exactly must be held instead.
RigPrior rig_prior(const Rig& like, const GaussianRigPrior& known);

/// A parameter of the rig that is not estimated. A component of a rotation is held as that
/// component of the rotation vector.
struct HeldParameter {
  std::string name;  ///< such as "left.ax" (see parameter_names)
  /// std::nullopt: ax 1, the principal point at the image centre, no distortion; a focal length or
  /// a component of a pose keeps its start value.
  std::optional<double> value;
};

/// The prior of a single parameter, independent of the others.
struct ParameterPrior {
  std::string name;
  double value = 0, sigma = 0;
};
GaussianRigPrior gaussian_prior_of(const Rig& like, const std::vector<ParameterPrior>& known);
RigPrior rig_prior(const Rig& like, const std::vector<ParameterPrior>& known);

/// The same prior about another mean.
RigPrior with_mean(const RigPrior& prior, Rig mean);

/// δ at `rig` and its derivative with respect to the left tangent at `rig`.
struct PriorOffset {
  Eigen::VectorXd delta;
  /// In the tangent the identity except for rotations, where it is J_l⁻¹.
  Eigen::MatrixXd by_rig;
};
PriorOffset prior_offset(const RigPrior& prior, const Rig& rig);

/// χ²_prior at `rig`.
double prior_chi2(const RigPrior& prior, const Rig& rig);

}  // namespace vernier
