// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier {

/// The difference in one parameter of two rigs.
struct ParameterDifference {
  std::string name;
  double a = 0, b = 0;  ///< of a rotation, its rotation vector
  double delta = 0;     ///< b against a in the tangent of calib/rig.h
  double sigma = 0;     ///< standard deviation of delta if both rigs are correct
  bool held = false;    ///< neither rig gives it a variance
};

/// δ along one principal direction of its scaled covariance.
struct DirectionDifference {
  double in_sigma = 0;  ///< standard deviations; their squares add up to d²
  std::string description;
};

/// Tests whether two calibrations agree within their uncertainties. With δ = b ⊖ a over the
/// parameters common to both by name and meaning, in the tangent of calib/rig.h (a rotation partly
/// held in both: by its rotation vector),
///
///     d² = δᵀ (C_a + C_b)⁻¹ δ     (Mahalanobis 1936)
///
/// chi-squared with the rank of C_a + C_b as degrees of freedom, if both are correct, normal and
/// independent. Evaluated with the eigenvectors of the scaled matrix; directions without variance
/// (below 1e-12 of the largest) are treated separately.
struct RigDifference {
  std::vector<ParameterDifference> parameters;    ///< those that both have
  std::vector<std::string> only_in_a, only_in_b;  ///< the others
  std::vector<DirectionDifference> directions;    ///< largest first
  std::vector<std::string>
      fixed_at_different_values;  ///< descriptions: no variance, but different values
  double mahalanobis2 = 0;        ///< d²; infinite if a fixed value differs
  int dof = 0;
  double p_value = 1;  ///< of a d² this large or larger
};

/// Throws Error if the rigs differ in the number, names or image sizes of their cameras, or if a
/// covariance is not over its rig's parameters.
RigDifference rig_difference(const Rig& a,
                             const Covariance& covariance_a,
                             const Rig& b,
                             const Covariance& covariance_b);

}  // namespace vernier
