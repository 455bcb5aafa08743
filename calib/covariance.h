// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace vernier {

/// Source of a covariance.
enum class CovarianceKind { mvb, clustered, jackknife, prior, combined };

std::string_view name(CovarianceKind kind);
/// Throws Error for any name but mvb, clustered, jackknife, prior, combined.
CovarianceKind covariance_kind(std::string_view name);

/// A covariance of the rig's free parameters with their names: rotations in the left tangent.
struct Covariance {
  CovarianceKind kind = CovarianceKind::prior;
  std::vector<std::string> names;
  Eigen::MatrixXd matrix;
};

/// One principal direction of the scaled covariance D⁻¹ C D⁻¹ = U diag(s) Uᵀ, D the standard
/// deviations.
struct CovarianceDirection {
  double variance_share = 0;   ///< s over the sum of all s, in [0, 1]
  double scaled_variance = 0;  ///< s
  Eigen::VectorXd direction;   ///< a column of U, unit, in standard deviations
  std::string description;     ///< description in words
};

/// Scaled singular value decomposition of a covariance: C = (D U √s)(D U √s)ᵀ.
class ScaledDecomposition {
 public:
  /// Throws Error, naming the direction, if `covariance` is not symmetric or not positive
  /// semi-definite.
  explicit ScaledDecomposition(const Covariance& covariance);

  /// D U √s, parameters x parameters: C = factor factorᵀ.
  const Eigen::MatrixXd& factor() const { return factor_; }
  /// Largest variance first.
  const std::vector<CovarianceDirection>& directions() const { return directions_; }
  /// Condition number of the covariance before and after scaling.
  double raw_condition() const { return raw_condition_; }
  double scaled_condition() const { return scaled_condition_; }

 private:
  Eigen::MatrixXd factor_;
  std::vector<CovarianceDirection> directions_;
  double raw_condition_ = 0, scaled_condition_ = 0;
};

/// Description of a unit direction: "0.9 of this direction is the right centre (x) against the
/// right camera's rotation about y".
std::string describe_direction(const Eigen::VectorXd& direction,
                               const std::vector<std::string>& names);

}  // namespace vernier
