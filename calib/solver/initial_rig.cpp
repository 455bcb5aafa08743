// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/initial_rig.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "calib/board/board_pose.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/initial_camera.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

using PoseOfView = std::map<std::pair<int, int>, Pose>;  // T_camera_board by (camera, frame)

double middle(std::vector<double> values) {
  return quantile(std::move(values), 0.5, QuantileKind::upper);
}

/// Angle (radians) plus the relative difference of the translations.
double distance(const Pose& a, const Pose& b) {
  return vector_from_rotation(a.R * b.R.transpose()).norm() +
         (a.t - b.t).norm() / (a.t.norm() + 1e-9);
}

std::string camera_name(int index) {
  return index == 0 ? "left" : index == 1 ? "right" : "camera" + std::to_string(index);
}

/// The rig's cameras one by one; also sets the board poses seen by each.
Rig cameras_alone(const BoardObservations& observations,
                  const std::vector<CameraModel>& models,
                  PoseOfView& T_camera_board) {
  Rig rig;
  for (int c = 0; c < static_cast<int>(observations.size_px.size()); ++c) {
    std::vector<BoardView> views;
    std::copy_if(observations.views.begin(), observations.views.end(), std::back_inserter(views),
                 [&](const BoardView& view) { return view.camera == c; });
    const InitialCamera start =
        initial_camera(observations, views, models[c], "camera " + std::to_string(c));
    for (std::size_t i = 0; i < views.size(); ++i) {
      T_camera_board[{c, views[i].frame}] = start.T_camera_board[i];
    }
    rig.cameras.push_back(start.camera);
    rig.cameras.back().name = camera_name(c);
  }
  return rig;
}

/// Frames that fit worse than usual get the pose that fits all their views best: a single view with
/// little perspective leaves open on which side of the line of sight the board is tilted.
void place_again(const BoardObservations& observations, BoardState& state) {
  constexpr double unusual = 1.5;  // times the median residual
  std::vector<double> rms_px;
  std::vector<std::vector<BoardView>> views;
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    views.push_back(at_frames(observations, {state.frames[f]}).views);
    const BoardPoseFit fit =
        fit_board_pose(observations.target_m, views[f], state.rig, state.T_first_board[f], 5);
    rms_px.push_back(fit.rms_px);
  }
  const double usual_px = middle(rms_px);
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    if (rms_px[f] <= unusual * usual_px) continue;
    try {
      const BoardPoseFit found = find_board_pose(observations.target_m, views[f], state.rig, 5);
      if (found.rms_px < rms_px[f]) state.T_first_board[f] = found.T_first_board;
    } catch (const Error&) {  // the pose stays
    }
  }
}

}  // namespace

Pose consensus_pose(const std::vector<Pose>& candidates) {
  double least = std::numeric_limits<double>::infinity();
  Pose centre;
  for (const Pose& candidate : candidates) {
    std::vector<double> distances;
    distances.reserve(candidates.size());
    for (const Pose& other : candidates) distances.push_back(distance(candidate, other));
    const double median = middle(std::move(distances));
    if (median < least) {
      least = median;
      centre = candidate;
    }
  }
  std::array<std::vector<double>, 6> tangents;
  for (const Pose& candidate : candidates) {
    if (distance(centre, candidate) > 3 * least) continue;
    const Eigen::Vector3d w = vector_from_rotation(candidate.R * centre.R.transpose());
    for (int i = 0; i < 3; ++i) {
      tangents[i].push_back(w[i]);
      tangents[3 + i].push_back(candidate.t[i] - centre.t[i]);
    }
  }
  if (candidates.empty()) return centre;
  Eigen::Matrix<double, 6, 1> delta;
  for (int i = 0; i < 6; ++i) delta[i] = middle(std::move(tangents[i]));
  return retract(centre, delta);
}

BoardState initial_state(const BoardObservations& observations,
                         const std::vector<CameraModel>& models) {
  BoardState state;
  state.frames = frames_of(observations);
  const int cameras = static_cast<int>(observations.size_px.size());
  PoseOfView T_camera_board;
  state.rig = cameras_alone(observations, models, T_camera_board);

  state.T_first_board.resize(state.frames.size());
  std::vector<std::optional<Pose>> placed(state.frames.size());  // T_first_board
  for (int c = 0; c < cameras; ++c) {
    std::vector<Pose> candidates;
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      const auto seen = T_camera_board.find({c, state.frames[f]});
      if (seen != T_camera_board.end() && placed[f]) {
        candidates.push_back(seen->second * placed[f]->inverse());
      }
    }
    if (c > 0 && candidates.empty()) {
      throw Error("camera " + std::to_string(c), "it shares no frame with the cameras before it",
                  "let both see the board at once, or order the cameras so that neighbours do");
    }
    state.rig.T_camera_first.push_back(consensus_pose(candidates));
    const Pose T_first_camera = state.rig.T_camera_first.back().inverse();
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      const auto seen = T_camera_board.find({c, state.frames[f]});
      if (seen != T_camera_board.end() && !placed[f]) placed[f] = T_first_camera * seen->second;
    }
  }
  for (std::size_t f = 0; f < placed.size(); ++f) state.T_first_board[f] = *placed[f];
  place_again(observations, state);
  return state;
}

}  // namespace vernier::internal
