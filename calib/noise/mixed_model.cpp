// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/mixed_model.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/error.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/scaled_factor.h"

namespace vernier::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Adds the terms of a view to Yᵀ W Y and Yᵀ W D.
void add_view(const LinearView& view,
              const std::vector<int>& ids,
              const MatrixXd& W,
              MatrixXd& products,
              MatrixXd& by_shape) {
  const Index n = W.rows();
  MatrixXd YtW(view.Yt.rows(), 2 * n);
  YtW.leftCols(n).noalias() = view.Yt.leftCols(n) * W;
  YtW.rightCols(n).noalias() = view.Yt.rightCols(n) * W;
  products(view.columns, view.columns) += YtW * view.Yt.transpose();
  if (view.by_point.cols() == 0) return;
  VectorXd column(view.Yt.rows());
  for (Index i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      column = view.by_point(axis, i) * YtW.col(i) + view.by_point(axis, n + i) * YtW.col(n + i);
      const Index at = 3 * ids[static_cast<std::size_t>(i)] + axis;
      for (Index k = 0; k < column.size(); ++k) {
        by_shape(view.columns[static_cast<std::size_t>(k)], at) += column[k];
      }
    }
  }
}

}  // namespace

std::vector<FieldCovariance> field_covariances(const std::vector<PointSet>& sets,
                                               const CornerNoise& noise,
                                               bool field) {
  const double white = noise.white_px * noise.white_px, power = noise.field_px * noise.field_px;
  std::vector<FieldCovariance> all;
  for (const PointSet& set : sets) {
    FieldCovariance& of_set = all.emplace_back();
    const auto n = static_cast<Index>(set.ids.size());
    if (!field) {
      of_set.inverse = MatrixXd::Identity(n, n) / white;
      of_set.log_determinant = static_cast<double>(n) * std::log(white);
      continue;
    }
    const MatrixXd d2 = set.squared_distances_m2 / (noise.field_length_m * noise.field_length_m);
    of_set.K = (-0.5 * d2.array()).exp();
    of_set.by_log_length = of_set.K.cwiseProduct(d2);
    MatrixXd C = power * of_set.K;
    C.diagonal().array() += white;
    const Cholesky factor(C);
    if (!factor.is_positive_definite()) {
      throw Error("corner noise", "white noise is too small beside the field", "give more views");
    }
    of_set.inverse = factor.inverse();
    of_set.log_determinant = 2 * factor.lower().diagonal().array().log().sum();
  }
  return all;
}

FrameEquations frame_equations(const LinearFrame& frame,
                               const Unknowns& unknowns,
                               const std::vector<PointSet>& sets,
                               const std::vector<FieldCovariance>& fields,
                               const VectorXd& own_information) {
  const Index rig = unknowns.rig, own = unknowns.own(), r = unknowns.residual();
  MatrixXd products = MatrixXd::Zero(unknowns.columns(), unknowns.columns());
  MatrixXd by_shape = MatrixXd::Zero(unknowns.columns(), unknowns.shape);
  for (const LinearView& view : frame.views) {
    add_view(view, sets[view.set].ids, fields[view.set].inverse, products, by_shape);
  }
  MatrixXd H(unknowns.common(), own);
  H << products.block(0, rig, rig, own), by_shape.middleRows(rig, own).transpose();
  MatrixXd T = products.block(rig, rig, own, own);
  T.diagonal() += own_information;
  const ScaledFactor factor(T, "the pose of frame " + std::to_string(frame.frame));
  MatrixXd HL = factor.times_inverse_upper(H);
  const VectorXd pull = products.block(rig, r, own, 1);
  VectorXd score(unknowns.common());
  score << products.block(0, r, rig, 1), by_shape.row(r).transpose();
  const VectorXd x = factor.solve(pull);
  score -= H * x;
  const double chi2 = products(r, r) - pull.dot(x);
  return {std::move(products), std::move(by_shape), std::move(H), factor,
          std::move(HL),       std::move(score),    chi2};
}

VectorXd FrameEquations::pull(const Unknowns& unknowns) const {
  return products.col(unknowns.residual()).segment(unknowns.rig, unknowns.own());
}

VectorXd FrameEquations::own(const Unknowns& unknowns, const VectorXd& z) const {
  return -T.solve(VectorXd(pull(unknowns) + H.transpose() * z));
}

void add_shape_block(const std::vector<int>& ids,
                     const MatrixXd& products,
                     const MatrixXd& W,
                     Index first,
                     MatrixXd& S) {
  const Index n = W.rows();
  const auto at = [&](Index i) { return first + 3 * ids[static_cast<std::size_t>(i)]; };
  for (int b = 0; b < 3; ++b) {
    for (Index j = 0; j < n; ++j) {
      for (int a = 0; a < 3; ++a) {
        for (Index i = 0; i < n; ++i) {
          S(at(i) + a, at(j) + b) += W(i, j) * products(a * n + i, b * n + j);
        }
      }
    }
  }
}

}  // namespace vernier::internal
