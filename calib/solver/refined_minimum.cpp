// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/refined_minimum.h"

#include <cstddef>

#include "calib/board/board_warp.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/estimate/held_parameters.h"
#include "calib/rig.h"
#include "calib/solver/square_root_system.h"

namespace vernier::internal {
namespace {

struct Linearisation {
  Eigen::MatrixXd free;  // directions
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
                        const std::vector<bool>& held) {
  const int n = parameter_count(state.rig);
  Linearisation out{free_directions(state.rig, held), SquareRootSystem(0), 0};
  const auto free = out.free.cols();
  out.system = SquareRootSystem(static_cast<int>(free));
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
    Eigen::MatrixXd free_rows(rows.rows(), 6 + free + 1);
    free_rows << rows.leftCols<6>(), rows.middleCols(6, n) * out.free, rows.rightCols<1>();
    out.system.add_frame(free_rows);
  }
  return out;
}

/// False if the views leave a direction undetermined.
bool move(BoardState& state, const Linearisation& at) {
  const Eigen::VectorXd step = at.system.step();
  const Eigen::VectorXd poses = at.system.frame_steps(step);
  if (!step.allFinite() || !poses.allFinite()) return false;
  state.rig = retract(state.rig, at.free * step);
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    state.T_first_board[f] =
        retract(state.T_first_board[f], poses.segment<6>(6 * static_cast<Eigen::Index>(f)));
  }
  return true;
}

}  // namespace

RefinedMinimum refine_minimum(const BoardObservations& observations,
                              const BoardState& start,
                              std::vector<bool> held) {
  constexpr int max_steps = 20;
  constexpr double enough_px = 1e-9;
  held.resize(parameter_count(start.rig), false);
  const auto target_m = warped_target(observations.target_m, start.warp_m);
  RefinedMinimum result;
  result.state = start;
  Linearisation at = linearise(observations, target_m, result.state, held);
  for (int i = 0; i < max_steps && !result.converged; ++i) {
    result.last_step_px = at.system.step_sigma();
    if (!move(result.state, at)) break;
    result.converged = result.last_step_px < enough_px;
    at = linearise(observations, target_m, result.state, held);
  }
  if (!result.converged) {
    result.state = start;
    at = linearise(observations, target_m, start, held);
  }
  result.cost_px2 = at.cost_px2;
  result.free_bound = at.system.covariance();
  result.unit_bound = at.free * result.free_bound * at.free.transpose();
  return result;
}

}  // namespace vernier::internal
