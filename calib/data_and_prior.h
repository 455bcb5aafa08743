// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace vernier {

/// One direction of the parameters, and what the data did for it.
struct ObservedDirection {
  double sd_ratio = 1;        ///< standard deviation after the data over that before
  Eigen::VectorXd direction;  ///< unit, in the prior's standard deviations
  std::string description;
};

/// What a calibration without a target owes to its data and what to its prior.
struct Observability {
  std::vector<ObservedDirection> directions;  ///< the most improved first
  double from_data = 0;  ///< how many of the parameters the data determine, tr(I − C C_0⁻¹)
  int improved = 0;      ///< directions known at least twice as well as before
  int unchanged = 0;     ///< directions whose standard deviation fell by less than a tenth
  /// The scale direction n (T → s T, all else held), which no pair can see: nᵀ C⁻¹ n over
  /// nᵀ C_0⁻¹ n, 1 whatever the data.
  double scale_information_ratio = 1;
  double baseline_sd_before_m = 0, baseline_sd_after_m = 0;  ///< of the length |T|

  /// Whether less than half of the parameters come from the data.
  bool is_prior_dominated() const { return 2 * from_data < static_cast<double>(directions.size()); }
};

/// Whether new data and what was known before them can be of one rig.
struct PriorConsistency {
  double chi2 = 0;      ///< squared, in standard deviations of agreement, over the directions seen
  int dof = 0;          ///< directions that the data improved
  int clusters = 0;     ///< that the scatter was estimated from; 0: it is known
  double p_value = 1;   ///< of a χ² this large or larger, by the law below
  double in_sigma = 0;  ///< along the direction that disagrees most …
  std::string description;  ///< … which is this
};

}  // namespace vernier
