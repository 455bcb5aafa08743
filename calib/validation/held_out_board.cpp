// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/held_out_board.h"

#include <cstddef>
#include <utility>

#include "calib/board/board_pose.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/noise/corner_covariance.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/triangulation.h"
#include "calib/validation/board_lengths.h"

namespace vernier::internal {
namespace {

MeasuredValue length(const PointTriangulation& a,
                     const PointTriangulation& b,
                     std::pair<int, int> ids,
                     double truth) {
  const Eigen::Vector3d d = b.x_m - a.x_m;
  const Eigen::RowVector3d unit = d.transpose() / d.norm();
  MeasuredValue m{d.norm(), truth, unit * (b.by_rig - a.by_rig), {}};
  m.by_pixels[ids.first] = -unit * a.by_pixels;
  m.by_pixels[ids.second] = unit * b.by_pixels;
  return m;
}

}  // namespace

HeldOutBoard::HeldOutBoard(const BoardObservations& observations,
                           int frame,
                           const SeenPair& seen,
                           const RigEstimate& estimate)
    : observations_(observations), frame_(frame) {
  std::vector<int> ids;
  for (const auto& [id, pixels] : seen) {
    const auto point = triangulate_point_with_jacobian(estimate.rig, pixels);
    if (!point) continue;
    points_.emplace(id, *point);
    ids.push_back(id);
  }
  for (const auto& ends : board_edges(observations.target_m, ids)) {
    const double truth =
        (observations.target_m[ends.first] - observations.target_m[ends.second]).norm();
    lengths_.push_back(length(points_.at(ends.first), points_.at(ends.second), ends, truth));
  }
}

MeasuredValue HeldOutBoard::scale() const {
  MeasuredValue mean{0, 1, Eigen::RowVectorXd::Zero(lengths_.at(0).by_rig.size()), {}};
  for (const MeasuredValue& m : lengths_) {
    const double weight = 1 / (m.truth * static_cast<double>(lengths_.size()));
    mean.value += weight * m.value;
    mean.by_rig += weight * m.by_rig;
    for (const auto& [id, J] : m.by_pixels) {
      mean.by_pixels.try_emplace(id, Eigen::RowVector4d::Zero()).first->second += weight * J;
    }
  }
  return mean;
}

FrameRows HeldOutBoard::rows(const RigEstimate& estimate) const {
  const BoardObservations views = at_frames(observations_, {frame_});
  const Eigen::Vector2d warp_m =
      estimate.evidence ? estimate.evidence->warp_m : Eigen::Vector2d::Zero();
  const auto target_m = warped_target(observations_.target_m, warp_m);
  const Pose pose = find_board_pose(target_m, views.views, estimate.rig).T_first_board;
  const Eigen::MatrixXd no_rig(parameter_count(estimate.rig), 0);
  return frame_rows(views, {estimate.rig, {frame_}, {pose}, warp_m}, no_rig)[0];
}

BoardVariances::BoardVariances(const RigEstimate& estimate,
                               const HeldOutBoard& board,
                               const CornerNoise& noise)
    : estimate_(estimate),
      rows_(board.rows(estimate)),
      corners_px2_(corner_covariance(rows_, noise, board.target_m())) {}

StatedVariances BoardVariances::of(const MeasuredValue& measured) const {
  double pixels = 0;
  for (const auto& [id, J] : measured.by_pixels) pixels += J.squaredNorm();
  Eigen::VectorXd by_rows = Eigen::VectorXd::Zero(rows_.residual_px.size());
  for (const ViewRows& view : rows_.views) {
    if (view.camera > 1) continue;
    const auto n = static_cast<Eigen::Index>(view.ids.size());
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = measured.by_pixels.find(view.ids[static_cast<std::size_t>(i)]);
      if (at == measured.by_pixels.end()) continue;
      by_rows[view.first + i] = at->second[2 * view.camera];
      by_rows[view.first + n + i] = at->second[2 * view.camera + 1];
    }
  }
  const double sigma = estimate_.calibration->pixel_sigma_px;
  const auto of_rig = [&](const Eigen::MatrixXd& C) {
    return measured.by_rig.dot(C * measured.by_rig.transpose());
  };
  const double honest = of_rig(estimate_.covariance->matrix);
  return {honest + sigma * sigma * pixels,
          of_rig(*estimate_.covariance_mvb) + sigma * sigma * pixels,
          honest + by_rows.dot(corners_px2_ * by_rows)};
}

}  // namespace vernier::internal
