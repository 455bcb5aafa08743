// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/board_lengths.h"

#include <cmath>
#include <cstddef>

#include "calib/board_observations.h"

namespace vernier::internal {

std::vector<SeenPair> seen_pairs(const BoardObservations& observations,
                                 const std::vector<int>& frames) {
  std::vector<SeenPair> pairs;
  for (const int frame : frames) {
    const BoardView *left = nullptr, *right = nullptr;
    for (const BoardView& view : observations.views) {
      if (view.frame != frame) continue;
      if (view.camera == 0) left = &view;
      if (view.camera == 1) right = &view;
    }
    SeenPair& pair = pairs.emplace_back();
    if (!left || !right) continue;
    std::map<int, Eigen::Vector2d> in_left;
    for (std::size_t i = 0; i < left->ids.size(); ++i) in_left[left->ids[i]] = left->pixels_px[i];
    for (std::size_t i = 0; i < right->ids.size(); ++i) {
      const auto found = in_left.find(right->ids[i]);
      if (found == in_left.end()) continue;
      pair[right->ids[i]] = {found->second, right->pixels_px[i]};
    }
  }
  return pairs;
}

std::vector<std::pair<int, int>> board_edges(const std::vector<Eigen::Vector3d>& target_m,
                                             const std::vector<int>& ids) {
  std::map<long, std::pair<int, int>> rows, columns;  // by position in micrometres: first, last
  std::pair<int, int> down{-1, -1}, up{-1, -1};
  const auto widen = [&](std::pair<int, int>& ends, int id, auto along) {
    if (ends.first < 0 || along(target_m[id]) < along(target_m[ends.first])) ends.first = id;
    if (ends.second < 0 || along(target_m[id]) > along(target_m[ends.second])) ends.second = id;
  };
  const auto x = [](const Eigen::Vector3d& X) { return X.x(); };
  const auto y = [](const Eigen::Vector3d& X) { return X.y(); };
  for (const int id : ids) {
    const Eigen::Vector3d& X = target_m[id];
    widen(rows.try_emplace(std::lround(1e6 * X.y()), -1, -1).first->second, id, x);
    widen(columns.try_emplace(std::lround(1e6 * X.x()), -1, -1).first->second, id, y);
    widen(down, id, [](const Eigen::Vector3d& Y) { return Y.x() + Y.y(); });
    widen(up, id, [](const Eigen::Vector3d& Y) { return Y.x() - Y.y(); });
  }
  std::vector<std::pair<int, int>> edges{down, up};
  for (const auto& lines : {rows, columns}) {
    for (const auto& [position, ends] : lines) edges.push_back(ends);
  }
  std::erase_if(edges, [](const auto& ends) { return ends.first == ends.second; });
  return edges;
}

}  // namespace vernier::internal
