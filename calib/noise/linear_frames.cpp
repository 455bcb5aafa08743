// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/linear_frames.h"

#include <map>
#include <utility>

#include "calib/error.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"

namespace vernier::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

PointSet point_set(const std::vector<int>& ids, const std::vector<Eigen::Vector3d>& target_m) {
  std::vector<Eigen::Vector3d> points_m;
  for (const int id : ids) points_m.push_back(target_m[static_cast<std::size_t>(id)]);
  return {ids, squared_distances(points_m), 0, {}};
}

/// Y of a frame, transposed.
MatrixXd transposed_columns(const FrameRows& rows, const Unknowns& unknowns) {
  MatrixXd Yt(unknowns.columns(), rows.residual_px.size());
  Yt.topRows(unknowns.rig) = rows.by_rig.transpose();
  Yt.middleRows(unknowns.rig, unknowns.motion) =
      rows.by_motion.leftCols(unknowns.motion).transpose();
  Yt.middleRows(unknowns.rig + unknowns.motion, 6) = rows.by_pose.transpose();
  Yt.row(unknowns.residual()) = rows.residual_px.transpose();
  return Yt;
}

LinearView linear_view(const ViewRows& view,
                       const MatrixXd& Yt,
                       const FrameRows& rows,
                       bool shape) {
  LinearView linear;
  linear.camera = view.camera;
  const Index count = 2 * static_cast<Index>(view.ids.size());
  const auto part = Yt.middleCols(view.first, count);
  for (Index k = 0; k < Yt.rows(); ++k) {
    if (!part.row(k).isZero(0)) linear.columns.push_back(k);
  }
  linear.Yt = part(linear.columns, Eigen::all);
  if (shape) linear.by_point = rows.by_point.middleRows(view.first, count).transpose();
  return linear;
}

}  // namespace

MatrixXd shape_products(const Eigen::Matrix3Xd& by_point) {
  const Index n = by_point.cols() / 2;
  MatrixXd D(3 * n, 2);
  for (int uv = 0; uv < 2; ++uv) {
    for (int axis = 0; axis < 3; ++axis) {
      D.col(uv).segment(axis * n, n) = by_point.row(axis).segment(uv * n, n).transpose();
    }
  }
  return D * D.transpose();
}

LinearFrames::LinearFrames(const std::vector<FrameRows>& rows_of_frames,
                           const std::vector<Eigen::Vector3d>& target_m,
                           NoiseParts parts) {
  if (rows_of_frames.empty()) throw Error("corner noise", "no frames", "give views of a board");
  unknowns.rig = rows_of_frames[0].by_rig.cols();
  if (parts.motion) unknowns.motion = rows_of_frames[0].by_motion.cols();
  if (parts.shape) unknowns.shape = 3 * static_cast<Index>(target_m.size());
  std::map<std::vector<int>, std::size_t> known;
  for (const FrameRows& rows : rows_of_frames) {
    if (rows.views.empty()) throw Error("corner noise", "a frame without views", "leave it out");
    const MatrixXd Yt = transposed_columns(rows, unknowns);
    LinearFrame& frame = frames.emplace_back();
    frame.frame = rows.frame;
    frame.motion_axes = rows.motion_axes;
    for (const ViewRows& view : rows.views) {
      LinearView linear = linear_view(view, Yt, rows, parts.shape);
      const auto [at, is_new] = known.try_emplace(view.ids, sets.size());
      if (is_new) sets.push_back(point_set(view.ids, target_m));
      linear.set = at->second;
      PointSet& set = sets[linear.set];
      set.coordinates += 2;
      if (parts.shape) {
        const MatrixXd products = shape_products(linear.by_point);
        if (set.shape_products.size() == 0) {
          set.shape_products = products;
        } else {
          set.shape_products += products;
        }
      }
      frame.views.push_back(std::move(linear));
    }
  }
}

}  // namespace vernier::internal
