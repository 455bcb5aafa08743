// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/world.h"

namespace vernier::test {

using namespace vernier::sim;

inline void add_rectangle(FeatureSet& features,
                          const Eigen::Vector3d& corner,
                          const Eigen::Vector3d& u,
                          const Eigen::Vector3d& v,
                          bool surface) {
  const std::vector<Eigen::Vector3d> loop{corner, corner + u, corner + u + v, corner + v};
  for (std::size_t k = 0; k < loop.size(); ++k) {
    features.segments_m.emplace_back(loop[k], loop[(k + 1) % loop.size()]);
  }
  if (surface) features.surfaces_m.push_back(loop);
}

/// A wall 4 m ahead of the origin, across +x, and a slanted panel 2 m ahead of it: four segments
/// border the panel, four outline a board 1 cm in front of the wall, one is a line on the wall, one
/// a rod in the air, and the wall has four of its own.
inline World panel_room() {
  WorldDescription d;
  d.name = "panel room";
  add_rectangle(d.loose, {4, -4, -1}, {0, 8, 0}, {0, 0, 5}, true);
  FeatureSet panel;
  add_rectangle(panel, {0, -0.5, 0.7}, {0, 0.9, 0.2}, {0, -0.2, 0.9}, true);
  d.templates.push_back({"panel", panel});
  FeatureSet board;
  add_rectangle(board, {3.99, 1.2, 1}, {0, 0.8, 0}, {0, 0, 0.6}, false);
  d.templates.push_back({"board", board});
  d.instances = {{"panel", {2, 0, 0}, 0}, {"board", {0, 0, 0}, 0}};
  d.loose.segments_m.push_back({{4, -2, 0.5}, {4, -2, 2}});
  d.loose.segments_m.push_back({{2.5, 1, 0.5}, {2.5, 1, 1.2}});
  return build_world(d);
}

}  // namespace vernier::test
