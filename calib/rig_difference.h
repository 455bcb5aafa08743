// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier {

/// One parameter of two rigs.
struct ParameterDifference {
  std::string name;
  double a = 0, b = 0;  ///< of a rotation, its rotation vector
  double delta = 0;     ///< b against a in the tangent of calib/rig.h
  double sigma = 0;     ///< standard deviation of delta if both rigs are right
  bool held = false;    ///< neither rig gives it a variance
};

/// δ along one principal direction of its scaled covariance.
struct DirectionDifference {
  double in_sigma = 0;  ///< standard deviations; their squares add up to d²
  std::string description;
};

/// Whether two calibrations agree within their uncertainties. With δ = b ⊖ a over the parameters
/// that both have by name and meaning, in the tangent of calib/rig.h (a rotation of which both hold
/// a part, by its rotation vector),
///
///     d² = δᵀ (C_a + C_b)⁻¹ δ     (Mahalanobis 1936)
///
/// chi-squared with as many degrees of freedom as C_a + C_b has rank, if both are right, normal and
/// independent. It is evaluated by the eigenvectors of the scaled matrix: directions without
/// variance (below 1e-12 of the largest) stand apart.
struct RigDifference {
  std::vector<ParameterDifference> parameters;    ///< those that both have
  std::vector<std::string> only_in_a, only_in_b;  ///< the others
  std::vector<DirectionDifference> directions;    ///< largest first
  std::vector<std::string>
      fixed_at_different_values;  ///< in words: no variance, and yet not the same
  double mahalanobis2 = 0;        ///< d²; infinite where something is held apart
  int dof = 0;
  double p_value = 1;  ///< of a d² this large or larger
};

/// Throws Error where the rigs are not of the same cameras (their number, their names or their
/// image sizes), or where a covariance is not one of its rig's parameters.
RigDifference rig_difference(const Rig& a,
                             const Covariance& covariance_a,
                             const Rig& b,
                             const Covariance& covariance_b);

}  // namespace vernier
