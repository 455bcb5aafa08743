// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/frame_rows.h"

#include <cstddef>

#include "calib/board/board_warp.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

/// From rows that alternate u and v to all u and then all v.
Eigen::MatrixXd by_coordinate(const Eigen::MatrixXd& rows) {
  const Eigen::Index n = rows.rows() / 2;
  Eigen::MatrixXd sorted(rows.rows(), rows.cols());
  for (Eigen::Index i = 0; i < n; ++i) {
    sorted.row(i) = rows.row(2 * i);
    sorted.row(n + i) = rows.row(2 * i + 1);
  }
  return sorted;
}

/// What all views of a calibration share.
struct Scene {
  const BoardState& state;
  const Eigen::MatrixXd& free;
  std::vector<Eigen::Vector3d> target_m;
  Eigen::Matrix<double, Eigen::Dynamic, 2> shapes;
  bool warps = false;
};

/// The mean of the corners that a frame's views show, in the first camera's frame.
Eigen::Vector3d centre_of(const Scene& scene,
                          const Pose& T_first_board,
                          const std::vector<const BoardView*>& views) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const BoardView* view : views) {
    for (const int id : view->ids) sum += scene.target_m[static_cast<std::size_t>(id)];
    count += static_cast<double>(view->ids.size());
  }
  return T_first_board * (sum / count);
}

void fill(const Scene& scene,
          std::size_t f,
          const BoardView& view,
          const Eigen::Vector3d& centre_m,
          FrameRows& rows) {
  const Rig& rig = scene.state.rig;
  const Pose& T_first_board = scene.state.T_first_board[f];
  const int c = view.camera;
  ViewLinearisation J;
  linearise_view(rig.cameras[c], rig.T_camera_first[c], T_first_board, scene.target_m, view,
                 Linearise::with_jacobian, J, scene.warps ? &scene.shapes : nullptr);
  const Eigen::Index first = rows.views.back().first, count = J.residual_px.size();
  Eigen::MatrixXd by_all = Eigen::MatrixXd::Zero(count, parameter_count(rig));
  by_all.middleCols(intrinsics_index(rig, c), J.by_camera.cols()) = J.by_camera;
  if (c > 0) by_all.middleCols<6>(pose_index(rig, c)) = J.by_camera_pose;
  rows.residual_px.segment(first, count) = by_coordinate(J.residual_px);
  rows.by_rig.block(first, 0, count, scene.free.cols()) = by_coordinate(by_all * scene.free);
  if (scene.warps) rows.by_rig.block(first, scene.free.cols(), count, 2) = by_coordinate(J.by_warp);
  const Eigen::MatrixXd by_pose = by_coordinate(J.by_board_pose);
  rows.by_pose.middleRows(first, count) = by_pose;
  rows.by_point.middleRows(first, count) = by_pose.rightCols<3>() * T_first_board.R;
  if (c == 0) return;
  const Eigen::Index at =
      6 * (c - 1);  // w × (P − t) + τ = w × (P − centre) + τ', τ = τ' + w × (t − centre)
  rows.by_motion.block(first, at, count, 3) =
      by_pose.leftCols<3>() - by_pose.rightCols<3>() * hat(T_first_board.t - centre_m);
  rows.by_motion.block(first, at + 3, count, 3) =
      by_pose.rightCols<3>() * rows.motion_axes[static_cast<std::size_t>(c - 1)];
}

}  // namespace

Eigen::Matrix3d motion_axes(const Rig& rig, int camera) {
  const Pose& T = rig.T_camera_first[static_cast<std::size_t>(camera)];
  const Eigen::Vector3d centre_m = -(T.R.transpose() * T.t);
  if (!(centre_m.norm() > 0)) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d axes;
  axes.col(0) = centre_m.normalized();
  axes.col(1) = axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

void add_board_unknowns(const std::vector<Eigen::Matrix3Xd>& board, FrameRows& rows) {
  const Eigen::Index rig = rows.by_rig.cols();
  rows.by_rig.conservativeResize(Eigen::NoChange, rig + static_cast<Eigen::Index>(board.size()));
  for (const ViewRows& view : rows.views) {
    const auto n = static_cast<Eigen::Index>(view.ids.size());
    for (Eigen::Index i = 0; i < n; ++i) {
      const int id = view.ids[static_cast<std::size_t>(i)];
      for (const Eigen::Index row : {view.first + i, view.first + n + i}) {
        Eigen::Index column = rig;
        for (const Eigen::Matrix3Xd& field : board) {
          rows.by_rig(row, column++) = rows.by_point.row(row).dot(field.col(id));
        }
      }
    }
  }
}

std::vector<FrameRows> frame_rows(const BoardObservations& observations,
                                  const BoardState& state,
                                  const Eigen::MatrixXd& free,
                                  BoardWarp warp) {
  const Scene scene{state, free, warped_target(observations.target_m, state.warp_m),
                    warp_shapes(observations.target_m), warp == BoardWarp::free};
  std::vector<FrameRows> all;
  std::vector<Eigen::Matrix3d> axes;
  for (std::size_t c = 1; c < state.rig.cameras.size(); ++c) {
    axes.push_back(motion_axes(state.rig, static_cast<int>(c)));
  }
  auto view = observations.views.begin();
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    std::vector<const BoardView*> views;
    Eigen::Index count = 0;
    FrameRows& rows = all.emplace_back();
    rows.frame = state.frames[f];
    rows.motion_axes = axes;
    for (; view != observations.views.end() && view->frame == rows.frame; ++view) {
      views.push_back(&*view);
      count += 2 * static_cast<Eigen::Index>(view->ids.size());
    }
    const auto motions = 6 * (static_cast<Eigen::Index>(state.rig.cameras.size()) - 1);
    rows.residual_px = Eigen::VectorXd::Zero(count);
    rows.by_rig = Eigen::MatrixXd::Zero(count, free.cols() + (scene.warps ? 2 : 0));
    rows.by_pose.setZero(count, 6);
    rows.by_point.setZero(count, 3);
    rows.by_motion = Eigen::MatrixXd::Zero(count, motions);
    if (views.empty()) continue;
    const Eigen::Vector3d centre_m = centre_of(scene, state.T_first_board[f], views);
    Eigen::Index first = 0;
    for (const BoardView* v : views) {
      rows.views.push_back({v->camera, v->ids, first});
      fill(scene, f, *v, centre_m, rows);
      first += 2 * static_cast<Eigen::Index>(v->ids.size());
    }
  }
  return all;
}

}  // namespace vernier::internal
