// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/rig.h"

namespace vernier::internal {

/// A quantity whose error is to be reduced, to first order in the rig's parameters: rows g of
/// derivatives, with the standard deviation
///
///     sd = sqrt(mean over the rows of g C gᵀ)
struct TargetQuantity {
  std::string name;          ///< in words: "depth at 5 m"
  std::string unit;          ///< m, px, rad or none
  Eigen::MatrixXd gradient;  ///< rows x parameters, in the tangent of calib/rig.h
};

/// The standard deviation under a covariance C = factor factorᵀ.
double sd_of(const TargetQuantity& wanted, const Eigen::MatrixXd& factor);

/// `what` is
///   depth          of a point on the left axis at `at_m`, from its pixels in both images (a pair)
///   projection     pixel of a point at `at_m` in the rig's frame, mean over all images' area; a
///                  row a coordinate
///   rectification  row of the rectified left image minus that of the right, of points at `at_m`
///   all
///                  over the left image (a pair)
///   baseline       |T| of the second camera
///   or the name of a parameter, such as left.f_px.
/// Throws Error for anything else, listing these, and if the rig lacks the cameras needed.
TargetQuantity target_quantity(const Rig& rig, const std::string& what, double at_m);

/// The same of some of the rig's cameras (calib/estimate/rig_part.h: part_of), to first order in
/// the parameters of the whole rig.
TargetQuantity target_quantity(const Rig& rig,
                               const std::vector<int>& cameras,
                               const std::string& what,
                               double at_m);

}  // namespace vernier::internal
