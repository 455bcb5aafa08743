// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace vernier {

/// One direction in parameter space, and how the data improved it.
struct ObservedDirection {
  double sd_ratio = 1;        ///< standard deviation after the data over that before
  Eigen::VectorXd direction;  ///< unit, in the prior's standard deviations
  std::string description;
};

/// How much of a targetless calibration comes from its data and how much from its prior.
struct Observability {
  std::vector<ObservedDirection> directions;  ///< most improved first
  double from_data = 0;  ///< number of parameters determined by the data, tr(I − C C_0⁻¹)
  int improved = 0;      ///< directions known at least twice as well as before
  int unchanged = 0;     ///< directions whose standard deviation fell by less than a tenth
  /// The scale direction n (T → s T, all else fixed), which no pair can observe: nᵀ C⁻¹ n over nᵀ
  /// C_0⁻¹ n, 1 for any data.
  double scale_information_ratio = 1;
  double baseline_sd_before_m = 0, baseline_sd_after_m = 0;  ///< of the length |T|

  /// Whether the data determine less than half of the parameters.
  bool is_prior_dominated() const { return 2 * from_data < static_cast<double>(directions.size()); }
};

/// Consistency test of new data with a prior.
struct PriorConsistency {
  double chi2 = 0;          ///< over the observed directions
  int dof = 0;              ///< number of directions that the data improved
  int clusters = 0;         ///< number used to estimate the scatter; 0: it is known
  double p_value = 1;       ///< of a χ² this large or larger (calib/estimate/prior_consistency.h)
  double in_sigma = 0;      ///< along the direction of largest disagreement …
  std::string description;  ///< … described here
};

}  // namespace vernier
