// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/average_information.h"

#include <cstddef>

#include "calib/noise/corner_noise.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/mixed_model.h"
#include "calib/noise/scaled_factor.h"

namespace vernier::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index components = 8, of_field = 3, motion_at = 3, of_motion = 3, shape_at = 6;

/// Products of the q of all components with W: Yᵀ W q of a frame, Dᵀ W q and qᵀ W q of all frames.
struct WeightedProducts {
  MatrixXd with_columns;
  MatrixXd with_shape;
  Eigen::Matrix<double, components, components> with_itself =
      Eigen::Matrix<double, components, components>::Zero();
};

/// Adds the terms of the columns w, g and ℓ in one view; `c`: the coefficients of ε of its frame.
void add_field(const LinearView& view,
               const PointSet& set,
               const FieldCovariance& field,
               const VectorXd& c,
               const VectorXd& s,
               const CornerNoise& noise,
               WeightedProducts& products) {
  const Index n = field.inverse.rows();
  VectorXd residuals = view.Yt.transpose() * c(view.columns);
  const auto first_column = [&](Index i) { return 3 * set.ids[static_cast<std::size_t>(i)]; };
  for (Index i = 0; view.by_point.cols() > 0 && i < n; ++i) {
    const Eigen::Vector3d point = s.segment<3>(first_column(i));
    residuals[i] += view.by_point.col(i).dot(point);
    residuals[n + i] += view.by_point.col(n + i).dot(point);
  }
  const double power = noise.field_px * noise.field_px;
  for (int uv = 0; uv < 2; ++uv) {
    const VectorXd e = field.inverse * residuals.segment(uv * n, n);
    MatrixXd q = MatrixXd::Zero(n, of_field);
    q.col(0) = 2 * noise.white_px * noise.white_px * e;
    if (field.K.size() > 0) {
      q.col(1) = 2 * power * (field.K * e);
      q.col(2) = power * (field.by_log_length * e);
    }
    const MatrixXd Wq = field.inverse * q;
    const MatrixXd YtWq = view.Yt.middleCols(uv * n, n) * Wq;
    for (Index k = 0; k < YtWq.rows(); ++k) {
      products.with_columns.row(view.columns[static_cast<std::size_t>(k)]).head<of_field>() +=
          YtWq.row(k);
    }
    for (Index i = 0; view.by_point.cols() > 0 && i < n; ++i) {
      products.with_shape.block<3, of_field>(first_column(i), 0) +=
          view.by_point.col(uv * n + i) * Wq.row(i);
    }
    products.with_itself.topLeftCorner<of_field, of_field>() += q.transpose() * Wq;
  }
}

/// −2 û of the shape in two groups, one column each: in the plane and in height.
MatrixXd shape_in_groups(const VectorXd& shape_m) {
  MatrixXd groups = MatrixXd::Zero(shape_m.size(), 2);
  for (Index i = 0; i < shape_m.size(); ++i) groups(i, i % 3 < 2 ? 0 : 1) = -2 * shape_m[i];
  return groups;
}

/// −2 û of a frame's motion in three groups: turning, across the baseline and along it.
MatrixXd motion_in_groups(const VectorXd& motion) {
  MatrixXd groups = MatrixXd::Zero(motion.size(), of_motion);
  for (Index i = 0; i < motion.size(); ++i) {
    groups(i, i % 6 < 3 ? 0 : i % 6 == 3 ? 2 : 1) = -2 * motion[i];
  }
  return groups;
}

/// Dᵀ W D of all frames.
MatrixXd shape_with_shape(const LinearFrames& linear, const std::vector<FieldCovariance>& fields) {
  MatrixXd DWD = MatrixXd::Zero(linear.unknowns.shape, linear.unknowns.shape);
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const PointSet& set = linear.sets[k];
    add_shape_block(set.ids, set.shape_products, fields[k].inverse, 0, DWD);
  }
  return DWD;
}

}  // namespace

Eigen::Matrix<double, 8, 8> average_information(const LinearFrames& linear,
                                                const std::vector<FieldCovariance>& fields,
                                                const std::vector<FrameEquations>& frames,
                                                const ScaledFactor& S,
                                                const VectorXd& z,
                                                const VectorXd& shape_m,
                                                const CornerNoise& noise) {
  const Unknowns& n = linear.unknowns;
  const MatrixXd shape_groups = shape_in_groups(shape_m);
  WeightedProducts all;
  all.with_shape = MatrixXd::Zero(n.shape, components);
  if (n.shape > 0) all.with_shape.rightCols<2>() = shape_with_shape(linear, fields) * shape_groups;
  MatrixXd scores = MatrixXd::Zero(n.common(), components);
  Eigen::Matrix<double, components, components> information;
  information.setZero();
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const FrameEquations& frame = frames[f];
    const VectorXd x = frame.own(n, z);
    VectorXd c(n.columns());
    c << z.head(n.rig), x, 1;
    all.with_columns = MatrixXd::Zero(n.columns(), components);
    for (const LinearView& view : linear.frames[f].views) {
      add_field(view, linear.sets[view.set], fields[view.set], c, z.tail(n.shape), noise, all);
    }
    const MatrixXd motion_groups = motion_in_groups(x.head(n.motion));
    all.with_columns.middleCols<of_motion>(motion_at) =
        frame.products.middleCols(n.rig, n.motion) * motion_groups;
    all.with_shape.middleCols<of_motion>(motion_at) +=
        frame.by_shape.middleRows(n.rig, n.motion).transpose() * motion_groups;
    all.with_columns.middleCols<2>(shape_at) = frame.by_shape * shape_groups;
    all.with_itself.middleCols<of_motion>(motion_at) +=
        all.with_columns.middleRows(n.rig, n.motion).transpose() * motion_groups;
    const MatrixXd pulls = all.with_columns.middleRows(n.rig, n.own());
    const MatrixXd moved = frame.T.solve(pulls);
    scores.topRows(n.rig) += all.with_columns.topRows(n.rig);
    scores -= frame.H * moved;
    information -= pulls.transpose() * moved;
  }
  scores.bottomRows(n.shape) += all.with_shape;
  all.with_itself.rightCols<2>() = all.with_shape.transpose() * shape_groups;
  all.with_itself.bottomLeftCorner<5, 3>() = all.with_itself.topRightCorner<3, 5>().transpose();
  all.with_itself.block<2, of_motion>(shape_at, motion_at) =
      all.with_itself.block<of_motion, 2>(motion_at, shape_at).transpose();
  return information + all.with_itself - scores.transpose() * S.solve(scores);
}

}  // namespace vernier::internal
