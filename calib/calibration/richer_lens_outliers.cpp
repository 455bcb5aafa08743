// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/richer_lens_outliers.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "calib/board/board_pose.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/calibration_problem.h"
#include "calib/calibration/outliers.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {
namespace {

/// The rig with opencv5 in place of simpler models; std::nullopt if there is none to replace.
std::optional<Rig> with_richer_lenses(const Rig& rig) {
  std::vector<CameraModel> rich = models_of(rig);
  bool richer = false;
  for (CameraModel& model : rich) {
    if (richer_models(model).size() < 2) continue;  // opencv5, opencv8, fisheye4 stay
    model = OpenCv5{};
    richer = true;
  }
  if (!richer) return {};
  return in_models(rig, rich);
}

}  // namespace

void replace_poses(BoardState& state, const BoardState& other) {
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    const auto at = std::lower_bound(other.frames.begin(), other.frames.end(), state.frames[f]);
    if (at == other.frames.end() || *at != state.frames[f]) continue;
    state.T_first_board[f] = other.T_first_board[at - other.frames.begin()];
  }
}

std::optional<RobustFit> outliers_by_richer_lenses(const BoardObservations& observations,
                                                   const BoardState& robust,
                                                   const RobustFit& fit,
                                                   const CalibrationOptions& options) {
  const std::optional<Rig> rig = with_richer_lenses(robust.rig);
  if (!rig) return {};
  BoardState whole = robust;
  try {
    ReprojectionProblem problem = problem_of(options, *rig);
    problem.must_converge = false;
    BoardState inside = fit.state;
    inside.rig = *rig;
    inside = minimise_reprojection(fit.inliers, inside, problem);
    whole.rig = inside.rig;
    whole.warp_m = inside.warp_m;
    replace_poses(whole, inside);
  } catch (const Error&) {
    return {};
  }
  const auto target_m = warped_target(observations.target_m, whole.warp_m);
  for (std::size_t f = 0; f < whole.frames.size(); ++f) {
    const int frame = whole.frames[f];
    if (std::binary_search(fit.state.frames.begin(), fit.state.frames.end(), frame)) continue;
    const std::vector<BoardView> views = at_frames(observations, {frame}).views;
    whole.T_first_board[f] =
        fit_board_pose(target_m, views, whole.rig, whole.T_first_board[f], 50).T_first_board;
  }
  return outliers_at(observations, whole);
}

}  // namespace vernier::internal
