// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"

namespace vernier::internal {

/// A frame in the eigenvectors of its fields, where V⁻¹ = diag(weights) − Z Zᵀ: columns of Z for
/// the motion and, with the pose projected out (Q in calib/noise/restricted_likelihood.h), for the
/// pose.
struct RotatedFrame {
  Eigen::VectorXd r;
  Eigen::VectorXd field;    ///< g² Λ; zero without a field
  Eigen::VectorXd weights;  ///< 1 / (w² + g² Λ)
  Eigen::MatrixXd A;        ///< by the rig, then by x, y and z of every point of the shape
  Eigen::MatrixXd B, M, Z;
  Eigen::MatrixXd ViB;                ///< V⁻¹ B
  Eigen::MatrixXd pose_inverse_root;  ///< L⁻ᵀ of Bᵀ V⁻¹ B
  Eigen::MatrixXd QA;
  Eigen::VectorXd Qr;
  double log_determinants = 0;  ///< ln|V| + ln|Bᵀ V⁻¹ B|

  /// diag(weights) X − Z Zᵀ X.
  Eigen::MatrixXd times(const Eigen::MatrixXd& X) const;
  /// Appends columns to Z.
  void project_out(const Eigen::MatrixXd& columns);
};

/// `spectra`: one per view, null without a field; `shape_columns` 0 without a shape. Throws Error
/// if the corners do not determine the pose.
RotatedFrame rotated_frame(const FrameRows& rows,
                           const CornerNoise& noise,
                           const std::vector<const FieldSpectrum*>& spectra,
                           bool motion,
                           Eigen::Index shape_columns);

}  // namespace vernier::internal
