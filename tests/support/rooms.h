// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/statistics/random.h"
#include "localise/place.h"

namespace vernier::test {

using namespace vernier::internal;
using namespace vernier::localise;

/// A random room as seen from its middle: upright, level and oblique lines within 5 m.
inline std::vector<PlaceLine> random_room(std::uint64_t seed, int lines = 40) {
  std::vector<PlaceLine> room;
  for (int i = 0; i < lines; ++i) {
    RandomStream d({.seed = seed, .feature = static_cast<std::uint32_t>(i)});
    PlaceLine line;
    line.a_m = {d.uniform(0.5, 5), d.uniform(-3, 3), d.uniform(0, 2)};
    line.sigma_m = 0.02;
    if (i % 3 == 0) {
      line.kind = LineKind::vertical;
      line.b_m = line.a_m + Eigen::Vector3d(0, 0, d.uniform(0.3, 1.5));
    } else if (i % 3 == 1) {
      line.kind = LineKind::level;
      const double angle = d.uniform(0, 3.14);
      line.b_m =
          line.a_m + d.uniform(0.4, 2) * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    } else {
      line.b_m = line.a_m + Eigen::Vector3d{d.uniform(-1, 1), d.uniform(-1, 1), d.uniform(0.5, 1)};
    }
    room.push_back(line);
  }
  return room;
}

/// One of many lines.
inline std::vector<PlaceLine> full_room(std::uint64_t seed) { return random_room(seed, 300); }

/// The same lines seen by a robot at `pose` in their frame.
inline std::vector<PlaceLine> seen_from(const std::vector<PlaceLine>& room, const Pose2D& pose) {
  const double c = std::cos(pose.heading_rad), s = std::sin(pose.heading_rad);
  std::vector<PlaceLine> seen = room;
  for (PlaceLine& line : seen) {
    for (Eigen::Vector3d* end : {&line.a_m, &line.b_m}) {
      const double x = end->x() - pose.x_m, y = end->y() - pose.y_m;
      *end = {c * x + s * y, -s * x + c * y, end->z()};
    }
  }
  return seen;
}

}  // namespace vernier::test
