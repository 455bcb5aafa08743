// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/likelihood_gradient.h"

#include <cstddef>

#include "calib/noise/corner_noise.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/mixed_model.h"

namespace vernier::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Second moments, given the data, of the coefficients of ε = Y c + D s: c of a frame's columns
/// (that of the residual is 1), s the shape.
struct SecondMoments {
  MatrixXd columns;    ///< E[c cᵀ]
  MatrixXd and_shape;  ///< E[c sᵀ]
};

/// `SHT`: S⁻¹ H T⁻¹ of the frame.
SecondMoments second_moments(const FrameEquations& frame,
                             const Unknowns& unknowns,
                             const MatrixXd& S_inverse,
                             const MatrixXd& T_inverse,
                             const MatrixXd& SHT,
                             const VectorXd& z) {
  const Index rig = unknowns.rig, own = unknowns.own(), shape = unknowns.shape;
  VectorXd c(unknowns.columns());
  c << z.head(rig), frame.own(unknowns, z), 1;
  SecondMoments moments{c * c.transpose(), c * z.tail(shape).transpose()};
  moments.columns.topLeftCorner(rig, rig) += S_inverse.topLeftCorner(rig, rig);
  moments.columns.block(0, rig, rig, own) -= SHT.topRows(rig);
  moments.columns.block(rig, 0, own, rig) -= SHT.topRows(rig).transpose();
  moments.columns.block(rig, rig, own, own) += T_inverse + T_inverse * (frame.H.transpose() * SHT);
  moments.and_shape.topRows(rig) += S_inverse.topRightCorner(rig, shape);
  moments.and_shape.middleRows(rig, own) -= SHT.bottomRows(shape).transpose();
  return moments;
}

/// Adds half of a view's term of N but that of the shape alone: Y (½ E[c cᵀ] Yᵀ + E[c sᵀ] Dᵀ) of
/// both coordinates; the other half is its transpose.
void add_view(const LinearView& view,
              const std::vector<int>& ids,
              const SecondMoments& moments,
              MatrixXd& N) {
  const Index n = N.rows();
  MatrixXd E = 0.5 * moments.columns(view.columns, view.columns) * view.Yt;
  if (view.by_point.cols() > 0) {
    const MatrixXd and_shape = moments.and_shape(view.columns, Eigen::all);
    for (Index i = 0; i < n; ++i) {
      const auto of_point = and_shape.middleCols<3>(3 * ids[static_cast<std::size_t>(i)]);
      E.col(i) += of_point * view.by_point.col(i);
      E.col(n + i) += of_point * view.by_point.col(n + i);
    }
  }
  N.noalias() += view.Yt.leftCols(n).transpose() * E.leftCols(n);
  N.noalias() += view.Yt.rightCols(n).transpose() * E.rightCols(n);
}

/// Σ D E[s sᵀ] Dᵀ over the coordinates of a set: of the points i and j the sum over their axes of
/// E[s sᵀ] times Σ d dᵀ.
MatrixXd of_shape(const PointSet& set, const MatrixXd& second_moments) {
  const auto n = static_cast<Index>(set.ids.size());
  const auto at = [&](Index i) { return 3 * set.ids[static_cast<std::size_t>(i)]; };
  MatrixXd sum = MatrixXd::Zero(n, n);
  if (set.shape_products.size() == 0) return sum;
  for (int b = 0; b < 3; ++b) {
    for (Index j = 0; j < n; ++j) {
      for (int a = 0; a < 3; ++a) {
        for (Index i = 0; i < n; ++i) {
          sum(i, j) +=
              second_moments(at(i) + a, at(j) + b) * set.shape_products(a * n + i, b * n + j);
        }
      }
    }
  }
  return sum;
}

/// S⁻¹ H T⁻¹ of all frames, side by side.
MatrixXd common_with_own(const std::vector<FrameEquations>& frames,
                         const std::vector<MatrixXd>& T_inverses,
                         const MatrixXd& S_inverse) {
  const Index own = T_inverses[0].rows();
  MatrixXd HT(S_inverse.rows(), own * static_cast<Index>(frames.size()));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    HT.middleCols(own * static_cast<Index>(f), own).noalias() = frames[f].H * T_inverses[f];
  }
  return S_inverse * HT;
}

}  // namespace

LikelihoodGradient likelihood_gradient(const LinearFrames& linear,
                                       const std::vector<FieldCovariance>& fields,
                                       const std::vector<FrameEquations>& frames,
                                       const MatrixXd& S_inverse,
                                       const VectorXd& z,
                                       const CornerNoise& noise) {
  const Unknowns& unknowns = linear.unknowns;
  const VectorXd sigmas = motion_sigmas(noise, unknowns.motion);
  LikelihoodGradient gradient;
  std::vector<MatrixXd> N, T_inverses;
  for (const FieldCovariance& field : fields) {
    N.push_back(MatrixXd::Zero(field.inverse.rows(), field.inverse.rows()));
  }
  for (const FrameEquations& frame : frames) T_inverses.push_back(frame.T.inverse());
  const MatrixXd SHT = common_with_own(frames, T_inverses, S_inverse);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const Index own = unknowns.own();
    const SecondMoments moments =
        second_moments(frames[f], unknowns, S_inverse, T_inverses[f],
                       SHT.middleCols(own * static_cast<Index>(f), own), z);
    for (const LinearView& view : linear.frames[f].views) {
      add_view(view, linear.sets[view.set].ids, moments, N[view.set]);
    }
    for (Index m = 0; m < unknowns.motion; ++m) {
      const Index at = unknowns.rig + m, group = m % 6 < 3 ? 0 : m % 6 == 3 ? 2 : 1;
      gradient.motion[group] += 2 * (1 - moments.columns(at, at) / (sigmas[m] * sigmas[m]));
    }
  }
  const VectorXd s = z.tail(unknowns.shape);
  const MatrixXd shape =
      S_inverse.bottomRightCorner(unknowns.shape, unknowns.shape) + s * s.transpose();
  const double white = noise.white_px * noise.white_px, power = noise.field_px * noise.field_px;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const FieldCovariance& field = fields[k];
    const MatrixXd& W = field.inverse;
    const MatrixXd moments = N[k] + N[k].transpose() + of_shape(linear.sets[k], shape);
    const MatrixXd by_C = linear.sets[k].coordinates * W - W * moments * W;
    gradient.field[0] += 2 * white * by_C.trace();
    if (field.K.size() == 0) continue;
    gradient.field[1] += 2 * power * field.K.cwiseProduct(by_C).sum();
    gradient.field[2] += power * field.by_log_length.cwiseProduct(by_C).sum();
  }
  return gradient;
}

}  // namespace vernier::internal
