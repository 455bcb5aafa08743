// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/refined_minimum.h"

#include "calib/board_warp.h"
#include "calib/error.h"
#include "calib/square_root_system.h"
#include "calib/view_linearisation.h"

namespace vernier {
namespace {

struct Linearisation {
  SquareRootSystem system;
  double cost_px2 = 0;
};

/// One view's rows of [B | A | r], A over all parameters of the rig.
void write_rows(const Rig& rig, int camera, const ViewLinearisation& J, Eigen::MatrixXd& rows) {
  const auto at = rows.rows();
  rows.conservativeResize(at + J.residual_px.size(), Eigen::NoChange);
  auto view = rows.bottomRows(J.residual_px.size());
  view.setZero();
  view.leftCols<6>() = J.by_board_pose;
  view.middleCols(6 + intrinsics_index(rig, camera), J.by_camera.cols()) = J.by_camera;
  if (camera > 0) view.middleCols<6>(6 + pose_index(rig, camera)) = J.by_camera_pose;
  view.rightCols<1>() = J.residual_px;
}

Linearisation linearise(const BoardObservations& observations,
                        const std::vector<Eigen::Vector3d>& target_m,
                        const BoardState& state,
                        const std::vector<int>& kept) {
  const int n = parameter_count(state.rig);
  Linearisation out{SquareRootSystem(static_cast<int>(kept.size()) - 7), 0};
  auto view = observations.views.begin();
  ViewLinearisation J;
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    Eigen::MatrixXd rows(0, 6 + n + 1);
    for (; view != observations.views.end() && view->frame == state.frames[f]; ++view) {
      const int c = view->camera;
      linearise_view(state.rig.cameras[c], state.rig.T_camera_first[c], state.T_first_board[f],
                     target_m, *view, Linearise::with_jacobian, J);
      write_rows(state.rig, c, J, rows);
      out.cost_px2 += J.residual_px.squaredNorm();
    }
    out.system.add_frame(rows(Eigen::all, kept));
  }
  return out;
}

/// Columns of [B | A | r] that stay: poses, free parameters, residual.
std::vector<int> kept_columns(int parameters, const std::vector<bool>& held) {
  std::vector<int> kept{0, 1, 2, 3, 4, 5};
  for (int i = 0; i < parameters; ++i) {
    if (i >= static_cast<int>(held.size()) || !held[i]) kept.push_back(6 + i);
  }
  kept.push_back(6 + parameters);
  return kept;
}

void move(BoardState& state, const SquareRootSystem& system, const std::vector<int>& kept) {
  const Eigen::VectorXd step = system.step();
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(parameter_count(state.rig));
  for (Eigen::Index i = 0; i < step.size(); ++i) delta[kept[6 + i] - 6] = step[i];
  const Eigen::VectorXd poses = system.frame_steps(step);
  if (!delta.allFinite() || !poses.allFinite()) {
    throw Error("calibration", "the views leave a direction free",
                "add views at other tilts and distances, or use a model with fewer parameters");
  }
  state.rig = retract(state.rig, delta);
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    state.T_first_board[f] =
        retract(state.T_first_board[f], poses.segment<6>(6 * static_cast<Eigen::Index>(f)));
  }
}

}  // namespace

RefinedMinimum refine_minimum(const BoardObservations& observations,
                              BoardState state,
                              const std::vector<bool>& held) {
  constexpr int most_steps = 20;
  constexpr double enough_px = 1e-9;
  const auto target_m = warped_target(observations.target_m, state.warp_m);
  const int n = parameter_count(state.rig);
  const std::vector<int> kept = kept_columns(n, held);
  RefinedMinimum result;
  Linearisation at = linearise(observations, target_m, state, kept);
  for (int i = 0; i < most_steps && !result.converged; ++i) {
    result.last_step_px = at.system.step_sigma();
    result.converged = result.last_step_px < enough_px;
    move(state, at.system, kept);
    at = linearise(observations, target_m, state, kept);
  }
  result.state = std::move(state);
  result.cost_px2 = at.cost_px2;
  result.unit_bound = Eigen::MatrixXd::Zero(n, n);
  std::vector<int> free;
  for (std::size_t i = 6; i + 1 < kept.size(); ++i) free.push_back(kept[i] - 6);
  result.unit_bound(free, free) = at.system.covariance();
  return result;
}

}  // namespace vernier
