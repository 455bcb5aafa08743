// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/scaled_factor.h"

namespace vernier::internal {

/// C = w² I + g² K of the corners of a point set, in each coordinate.
struct FieldCovariance {
  Eigen::MatrixXd K;              ///< empty without a field
  Eigen::MatrixXd by_log_length;  ///< ∂K / ∂ln ℓ
  Eigen::MatrixXd inverse;        ///< C⁻¹
  double log_determinant = 0;
};

/// Of every set. Throws Error if white noise is too small beside the field.
std::vector<FieldCovariance> field_covariances(const std::vector<PointSet>& sets,
                                               const CornerNoise& noise,
                                               bool field);

/// Henderson's mixed model equations (Henderson 1975; Robinson 1991) of one frame: of the unknowns
/// z of all frames and its own x, with W = C⁻¹ for each view and coordinate,
///
///     [ Aᵀ W A        Aᵀ W X           ] [ z ]      [ Aᵀ W r ]
///     [ Xᵀ W A    T = Xᵀ W X + Σ_x⁻¹   ] [ x ] = −  [ Xᵀ W r ]
///
/// Σ_x⁻¹ holds the inverse variances of the motion and zeros for the pose. x is eliminated:
/// Q = W − W X T⁻¹ Xᵀ W is that of calib/noise/restricted_likelihood.h.
struct FrameEquations {
  Eigen::MatrixXd products;  ///< Yᵀ W Y, Y = [rig, motion, pose, residual]
  Eigen::MatrixXd by_shape;  ///< Yᵀ W D
  Eigen::MatrixXd H;         ///< Aᵀ W X, common x own
  ScaledFactor T;            ///< L Lᵀ
  Eigen::MatrixXd HL;        ///< H L⁻ᵀ
  Eigen::VectorXd score;     ///< Aᵀ Q r
  double chi2 = 0;           ///< rᵀ Q r

  /// Xᵀ W r
  Eigen::VectorXd pull(const Unknowns& unknowns) const;
  /// x at this z.
  Eigen::VectorXd own(const Unknowns& unknowns, const Eigen::VectorXd& z) const;
};

/// `own_information`: the diagonal of Σ_x⁻¹. Throws Error if the corners do not determine the pose.
FrameEquations frame_equations(const LinearFrame& frame,
                               const Unknowns& unknowns,
                               const std::vector<PointSet>& sets,
                               const std::vector<FieldCovariance>& fields,
                               const Eigen::VectorXd& own_information);

/// Adds Dᵀ W D to the shape's block of S. D is sparse, a corner's two rows have the three columns
/// of its point, so that the block of the points i and j is W_ij times that of `products`
/// (PointSet::shape_products): the frames need not be visited.
void add_shape_block(const std::vector<int>& ids,
                     const Eigen::MatrixXd& products,
                     const Eigen::MatrixXd& W,
                     Eigen::Index first,
                     Eigen::MatrixXd& S);

}  // namespace vernier::internal
