// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/merged_boards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/board_warp.h"
#include "calib/error.h"

namespace vernier {
namespace {

void check_sizes(const BoardObservations& observations, const Rig& rig) {
  bool same = observations.size_px.size() == rig.cameras.size();
  for (std::size_t c = 0; same && c < rig.cameras.size(); ++c) {
    same = observations.size_px[c] == rig.cameras[c].size_px;
  }
  if (same) return;
  throw Error("combination", "views of a board are of other cameras than the rig",
              "combine calibrations of one rig");
}

/// Where the term's target stands in the merged one, adding it if it is not there yet.
int place_target(const std::vector<Eigen::Vector3d>& target_m,
                 std::vector<Eigen::Vector3d>& merged_m) {
  const auto found =
      std::search(merged_m.begin(), merged_m.end(), target_m.begin(), target_m.end());
  const auto offset = static_cast<int>(found - merged_m.begin());
  if (found == merged_m.end()) merged_m.insert(merged_m.end(), target_m.begin(), target_m.end());
  return offset;
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
  int next_frame = 0;
  for (const BoardTerm& term : terms) {
    const CalibrationEvidence& evidence = term.evidence;
    check_sizes(evidence.observations, rig);
    const int offset = place_target(warped_target(evidence.observations.target_m, evidence.warp_m),
                                    merged.observations.target_m);
    const double weight = std::pow(merged.pixel_sigma_px / term.pixel_sigma_px, 2);
    merged.parts.push_back({merged.state.frames.size(), evidence.frames.size()});
    for (BoardView view : evidence.observations.views) {
      const auto at = std::lower_bound(evidence.frames.begin(), evidence.frames.end(), view.frame);
      view.frame = next_frame + static_cast<int>(at - evidence.frames.begin());
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
  own.warp_m = terms[term].evidence.warp_m;
  return own;
}

CalibrationEvidence merged_evidence(const MergedBoards& boards, const BoardState& state) {
  CalibrationEvidence evidence;
  evidence.observations = boards.observations;
  evidence.frames = state.frames;
  evidence.T_first_board = state.T_first_board;
  return evidence;
}

}  // namespace vernier
