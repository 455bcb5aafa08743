// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/floor_plan_votes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/verification/upright_pairs.h"

namespace vernier::localise::internal {

namespace {

/// Lines that may be the same. A line of the query votes once for a cell, with this weight.
struct Pairings {
  PairColumns positions;
  std::vector<std::int32_t> line;  // of the query, ascending
  std::vector<float> weight;
};

Pairings pairings(std::span<const PlanUpright> query,
                  std::span<const PlanUpright> node,
                  const Pose2D& around,
                  const VoteOptions& o) {
  constexpr float blur_m = 0.15f;  // a line whose distance is known worse votes less
  const auto cell = static_cast<float>(o.cell_m);
  const auto x0 = static_cast<float>(around.x_m), y0 = static_cast<float>(around.y_m);
  const auto c = static_cast<float>(std::cos(around.heading_rad));
  const auto s = static_cast<float>(std::sin(around.heading_rad));
  // A line of the query moves along an arc as it turns, and by the shifts to every side.
  const float turned = static_cast<float>(o.turn_steps) * static_cast<float>(o.turn_step_rad);
  const float shifted = std::numbers::sqrt2_v<float> * (static_cast<float>(o.span_m) + cell);
  const UprightColumns columns(node);
  Pairings pairs;
  std::vector<std::int32_t> room;
  for (std::size_t i = 0; i < query.size(); ++i) {
    const PlanUpright& q = query[i];
    const float range = std::sqrt(q.x_m * q.x_m + q.y_m * q.y_m);
    UprightColumns::Strip strip;
    strip.ux = range > 0 ? (c * q.x_m - s * q.y_m) / range : 1;
    strip.uy = range > 0 ? (s * q.x_m + c * q.y_m) / range : 0;
    const float from = strip.ux * x0 + strip.uy * y0;
    strip.along_low = from + range * std::cos(turned) - shifted;
    strip.along_high = from + range + shifted;
    strip.across = strip.ux * y0 - strip.uy * x0;
    strip.across_most = range * std::sin(turned) + shifted;
    for (const std::int32_t k : columns.within(strip, q, room)) {
      const PlanUpright& n = node[k];
      pairs.positions.add(q.x_m / cell, q.y_m / cell, (n.x_m - x0) / cell, (n.y_m - y0) / cell);
      pairs.line.push_back(static_cast<std::int32_t>(i));
      pairs.weight.push_back(1 / (1 + (q.sigma_m + n.sigma_m) / blur_m));
    }
  }
  pairs.positions.pad();
  return pairs;
}

/// A cell of one turn's votes, with its neighbours'.
struct Cell {
  float votes;
  int turn, x, y;
};

}  // namespace

std::vector<PlanUpright> plan_uprights(std::span<const PlaceLine> lines) {
  std::vector<PlanUpright> uprights;
  for (const PlaceLine& line : lines) {
    if (line.kind != LineKind::vertical || !(line.sigma_m >= 0)) continue;
    const Eigen::Vector3f middle = (0.5 * (line.a_m + line.b_m)).cast<float>();
    uprights.push_back({middle.x(), middle.y(),
                        static_cast<float>(std::min(line.a_m.z(), line.b_m.z())),
                        static_cast<float>(std::max(line.a_m.z(), line.b_m.z())),
                        static_cast<float>(line.sigma_m)});
  }
  return uprights;
}

std::vector<PlanUpright> plan_uprights(const SpaceLines& lines) {
  constexpr float most_slope = 1e-3f;  // vertical lines are exactly so, but for rounding
  std::vector<PlanUpright> uprights;
  for (std::size_t i = 0; i < lines.size; ++i) {
    const Eigen::Vector3f a = lines.a_m(i), b = lines.b_m(i), d = b - a;
    if (d.head<2>().norm() > most_slope * std::abs(d.z())) continue;
    uprights.push_back({0.5f * (a.x() + b.x()), 0.5f * (a.y() + b.y()), std::min(a.z(), b.z()),
                        std::max(a.z(), b.z()), lines.sigma_m[i]});
  }
  return uprights;
}

bool heights_agree(const PlanUpright& a, const PlanUpright& b) {
  const float common = std::min(a.high_m, b.high_m) - std::max(a.low_m, b.low_m);
  return common >= least_common_height * std::min(a.high_m - a.low_m, b.high_m - b.low_m);
}

std::vector<VotePeak> vote(std::span<const PlanUpright> query,
                           std::span<const PlanUpright> node,
                           const Pose2D& around,
                           const VoteOptions& o) {
  // The strip in which partners are looked for takes a turn below a right angle.
  assert(o.turn_step_rad * o.turn_steps < std::numbers::pi / 2);
  const Pairings pairs = pairings(query, node, around, o);
  const int half = static_cast<int>(std::lround(o.span_m / o.cell_m)), side = 2 * half + 3;
  const auto cells = static_cast<std::size_t>(side) * side;
  std::vector<float> votes;
  std::vector<std::int32_t> at_cell, of_pair, last;  // line that voted for a cell: each counts once
  std::vector<Cell> found;
  for (int turn = -o.turn_steps; turn <= o.turn_steps; ++turn) {
    const double angle = around.heading_rad + turn * o.turn_step_rad;
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    votes.assign(cells, 0.0f);
    last.assign(cells, -1);
    const std::size_t inside = pairs.positions.shift_cells(c, s, side, at_cell, of_pair);
    for (std::size_t i = 0; i < inside; ++i) {
      const std::int32_t at = at_cell[i], line = pairs.line[of_pair[i]];
      if (std::exchange(last[at], line) != line) votes[at] += pairs.weight[of_pair[i]];
    }
    for (int y = 1; y < side - 1; ++y) {
      for (int x = 1; x < side - 1; ++x) {
        const float* at = &votes[static_cast<std::size_t>(y) * side + x];
        const float cross = at[0] + at[1] + at[-1] + at[side] + at[-side];
        if (cross == 0) continue;
        const float corners = at[side + 1] + at[side - 1] + at[-side + 1] + at[-side - 1];
        found.push_back(
            {at[0] + 0.5f * (cross - at[0] + corners), turn, x - half - 1, y - half - 1});
      }
    }
  }
  constexpr std::size_t most_cells = 100;
  const auto better = [](const Cell& a, const Cell& b) {
    return std::tie(b.votes, a.turn, a.y, a.x) < std::tie(a.votes, b.turn, b.y, b.x);
  };
  if (found.size() > most_cells) {
    std::nth_element(found.begin(), found.begin() + most_cells, found.end(), better);
    found.resize(most_cells);
  }
  std::sort(found.begin(), found.end(), better);
  constexpr double apart_m = 0.25;
  std::vector<VotePeak> peaks;
  std::vector<Cell> kept;
  for (const Cell& cell : found) {
    if (static_cast<int>(kept.size()) >= o.peaks) break;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Cell& k) {
      return std::hypot(k.x - cell.x, k.y - cell.y) * o.cell_m < apart_m &&
             std::abs(k.turn - cell.turn) <= 2;
    });
    if (!is_new) continue;
    kept.push_back(cell);
    peaks.push_back({{around.x_m + cell.x * o.cell_m, around.y_m + cell.y * o.cell_m,
                      around.heading_rad + cell.turn * o.turn_step_rad},
                     cell.votes});
  }
  return peaks;
}

}  // namespace vernier::localise::internal
