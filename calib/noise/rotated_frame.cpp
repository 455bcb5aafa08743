// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/rotated_frame.h"

#include <cstddef>
#include <string>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/scaled_factor.h"

namespace vernier::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd rotate(const MatrixXd& X,
                const FrameRows& rows,
                const std::vector<const FieldSpectrum*>& spectra) {
  MatrixXd out(X.rows(), X.cols());
  for (std::size_t v = 0; v < rows.views.size(); ++v) {
    const auto n = static_cast<Index>(rows.views[v].ids.size());
    for (int uv = 0; uv < 2; ++uv) {
      const Index first = rows.views[v].first + uv * n;
      if (spectra[v]) {
        out.middleRows(first, n).noalias() = spectra[v]->U.transpose() * X.middleRows(first, n);
      } else {
        out.middleRows(first, n) = X.middleRows(first, n);
      }
    }
  }
  return out;
}

/// The columns of the shape: x, y and z of point 0, then of point 1 …, rotated.
void add_shape_columns(const FrameRows& rows,
                       const std::vector<const FieldSpectrum*>& spectra,
                       Index first_column,
                       MatrixXd& A) {
  for (std::size_t v = 0; v < rows.views.size(); ++v) {
    const auto n = static_cast<Index>(rows.views[v].ids.size());
    for (int uv = 0; uv < 2; ++uv) {
      const Index first = rows.views[v].first + uv * n;
      for (Index i = 0; i < n; ++i) {
        const Index column = first_column + 3 * rows.views[v].ids[static_cast<std::size_t>(i)];
        for (int axis = 0; axis < 3; ++axis) {
          const double by = rows.by_point(first + i, axis);
          if (spectra[v]) {
            A.col(column + axis).segment(first, n) += by * spectra[v]->U.row(i).transpose();
          } else {
            A(first + i, column + axis) += by;
          }
        }
      }
    }
  }
}

/// g² Λ of every row.
VectorXd field_variances(const FrameRows& rows,
                         const CornerNoise& noise,
                         const std::vector<const FieldSpectrum*>& spectra) {
  VectorXd variances = VectorXd::Zero(rows.residual_px.size());
  for (std::size_t v = 0; v < rows.views.size(); ++v) {
    if (!spectra[v]) continue;
    const VectorXd of_view = noise.field_px * noise.field_px * spectra[v]->values;
    variances.segment(rows.views[v].first, of_view.size()) = of_view;
    variances.segment(rows.views[v].first + of_view.size(), of_view.size()) = of_view;
  }
  return variances;
}

/// Adds the motion to V⁻¹ = W, by Woodbury's identity: with N = M diag(s),
/// V⁻¹ = W − W N (I + Nᵀ W N)⁻¹ Nᵀ W.
void add_motion(const CornerNoise& noise, RotatedFrame& f) {
  MatrixXd N = f.M;
  for (Index k = 0; k < N.cols(); ++k) N.col(k) *= k % 6 < 3 ? noise.motion_rad : noise.motion_m;
  const MatrixXd WN = f.weights.asDiagonal() * N;
  const Cholesky inner(MatrixXd::Identity(N.cols(), N.cols()) + N.transpose() * WN);
  f.log_determinants += 2 * inner.lower().diagonal().array().log().sum();
  f.project_out(inner.times_inverse_upper(WN));
}

}  // namespace

MatrixXd RotatedFrame::times(const MatrixXd& X) const {
  return weights.asDiagonal() * X - Z * (Z.transpose() * X);
}

void RotatedFrame::project_out(const MatrixXd& columns) {
  MatrixXd both(columns.rows(), Z.cols() + columns.cols());
  both << Z, columns;
  Z = std::move(both);
}

RotatedFrame rotated_frame(const FrameRows& rows,
                           const CornerNoise& noise,
                           const std::vector<const FieldSpectrum*>& spectra,
                           bool motion,
                           Index shape_columns) {
  RotatedFrame f;
  const Index count = rows.residual_px.size(), rig = rows.by_rig.cols();
  f.field = field_variances(rows, noise, spectra);
  const VectorXd diagonal = f.field.array() + noise.white_px * noise.white_px;
  f.weights = diagonal.cwiseInverse();
  f.log_determinants = diagonal.array().log().sum();
  f.r = rotate(rows.residual_px, rows, spectra);
  f.A = MatrixXd::Zero(count, rig + shape_columns);
  f.A.leftCols(rig) = rotate(rows.by_rig, rows, spectra);
  if (shape_columns > 0) add_shape_columns(rows, spectra, rig, f.A);
  f.B = rotate(rows.by_pose, rows, spectra);
  f.Z.resize(count, 0);
  if (motion) {
    f.M = rotate(rows.by_motion, rows, spectra);
    add_motion(noise, f);
  }
  f.ViB = f.times(f.B);
  const ScaledFactor pose(f.B.transpose() * f.ViB,
                          "the pose of frame " + std::to_string(rows.frame));
  f.log_determinants += pose.log_determinant();
  f.pose_inverse_root = pose.times_inverse_upper(MatrixXd::Identity(6, 6));
  f.project_out(f.ViB * f.pose_inverse_root);
  f.QA = f.times(f.A);
  f.Qr = f.times(f.r);
  return f;
}

}  // namespace vernier::internal
