// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_state.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "calib/error.h"

namespace vernier {

std::size_t frame_index(const std::vector<int>& frames, int frame) {
  const auto at = std::lower_bound(frames.begin(), frames.end(), frame);
  if (at != frames.end() && *at == frame) return static_cast<std::size_t>(at - frames.begin());
  throw Error("frame " + std::to_string(frame), "it has a view but no board pose",
              "give one board pose for every frame with views");
}

BoardState at_frames(const BoardState& state, const std::vector<int>& frames) {
  BoardState part = state;
  part.frames.clear();
  part.T_first_board.clear();
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    if (!std::binary_search(frames.begin(), frames.end(), state.frames[f])) continue;
    part.frames.push_back(state.frames[f]);
    part.T_first_board.push_back(state.T_first_board[f]);
  }
  return part;
}

}  // namespace vernier
