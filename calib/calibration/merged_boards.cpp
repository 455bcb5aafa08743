// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/merged_boards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/joint_calibration.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {
namespace {

void check_sizes(const BoardObservations& observations, const Rig& rig) {
  bool same = observations.size_px.size() == rig.cameras.size();
  for (std::size_t c = 0; same && c < rig.cameras.size(); ++c) {
    same = observations.size_px[c] == rig.cameras[c].size_px;
  }
  if (same) return;
  throw Error("combination", "its board views are of other cameras than the rig's",
              "combine calibrations of one rig");
}

/// Index of the term's target in the merged one; added if it is new.
int place_target(const std::vector<Eigen::Vector3d>& target_m,
                 std::vector<Eigen::Vector3d>& merged_m) {
  const auto found =
      std::search(merged_m.begin(), merged_m.end(), target_m.begin(), target_m.end());
  const auto offset = static_cast<int>(found - merged_m.begin());
  if (found == merged_m.end()) merged_m.insert(merged_m.end(), target_m.begin(), target_m.end());
  return offset;
}

bool is_bent(const BoardTerm& term) { return term.evidence.warp_m != Eigen::Vector2d::Zero(); }

/// Whether all targets are equal. If so, they become one, starting from the mean warp; else
/// several.
bool take_one_board(const std::vector<BoardTerm>& terms, MergedBoards& merged) {
  const bool bent = std::any_of(terms.begin(), terms.end(), is_bent);
  for (const BoardTerm& term : terms) {
    if (term.evidence.observations.target_m == terms[0].evidence.observations.target_m) continue;
    merged.warps_assumed_known = bent;
    return false;
  }
  if (!bent) return true;
  merged.warp = BoardWarp::free;
  for (const BoardTerm& term : terms) {
    merged.state.warp_m += term.evidence.warp_m / static_cast<double>(terms.size());
  }
  return true;
}

}  // namespace

MergedBoards merge_boards(const std::vector<BoardTerm>& terms, const Rig& rig) {
  MergedBoards merged;
  merged.state.rig = rig;
  for (const Camera& camera : rig.cameras) {
    merged.observations.size_px.push_back(camera.size_px);
  }
  for (const BoardTerm& term : terms) {
    merged.pixel_sigma_px = &term == terms.data()
                                ? term.pixel_sigma_px
                                : std::min(merged.pixel_sigma_px, term.pixel_sigma_px);
  }
  const bool one_board = take_one_board(terms, merged);
  int next_frame = 0;
  for (const BoardTerm& term : terms) {
    const CalibrationEvidence& evidence = term.evidence;
    check_sizes(evidence.observations, rig);
    const Eigen::Vector2d known_warp_m = one_board ? Eigen::Vector2d(0, 0) : evidence.warp_m;
    const int offset = place_target(warped_target(evidence.observations.target_m, known_warp_m),
                                    merged.observations.target_m);
    const double weight = std::pow(merged.pixel_sigma_px / term.pixel_sigma_px, 2);
    merged.parts.push_back({merged.state.frames.size(), evidence.frames.size()});
    for (BoardView view : evidence.observations.views) {
      view.frame = next_frame + static_cast<int>(frame_index(evidence.frames, view.frame));
      for (int& id : view.ids) id += offset;
      merged.corner_weights.emplace_back(view.ids.size(), weight);
      merged.observations.views.push_back(std::move(view));
    }
    for (const Pose& T : evidence.T_first_board) {
      merged.state.frames.push_back(next_frame++);
      merged.state.T_first_board.push_back(T);
    }
  }
  return merged;
}

BoardState state_of(const MergedBoards& boards,
                    const std::vector<BoardTerm>& terms,
                    const BoardState& state,
                    std::size_t term) {
  const MergedBoards::Part& part = boards.parts[term];
  const auto first = state.T_first_board.begin() + static_cast<std::ptrdiff_t>(part.first_frame);
  BoardState own;
  own.rig = state.rig;
  own.frames = terms[term].evidence.frames;
  own.T_first_board.assign(first, first + static_cast<std::ptrdiff_t>(part.frames));
  own.warp_m =
      boards.warp == BoardWarp::free ? state.warp_m : Eigen::Vector2d(terms[term].evidence.warp_m);
  return own;
}

CalibrationEvidence merged_evidence(const MergedBoards& boards, const BoardState& state) {
  CalibrationEvidence evidence;
  evidence.observations = boards.observations;
  evidence.frames = state.frames;
  evidence.T_first_board = state.T_first_board;
  evidence.warp_m = state.warp_m;
  return evidence;
}

}  // namespace vernier::internal
