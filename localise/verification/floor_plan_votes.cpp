// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/floor_plan_votes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "localise/place.h"
#include "localise/place/space_lines.h"

namespace vernier::localise::internal {

namespace {

/// Positions of lines that may be the same, in cells, and the weight of their vote.
struct Pairing {
  int line;  ///< of the query
  float query_x, query_y, node_x, node_y, weight;
};

std::vector<Pairing> pairings(std::span<const PlanUpright> query,
                              std::span<const PlanUpright> node,
                              const Pose2D& around,
                              const VoteOptions& o) {
  constexpr float blur_m = 0.15f;  // a line whose distance is known worse votes less
  const auto cell = static_cast<float>(o.cell_m);
  const auto x0 = static_cast<float>(around.x_m), y0 = static_cast<float>(around.y_m);
  const auto c = static_cast<float>(std::cos(around.heading_rad));
  const auto s = static_cast<float>(std::sin(around.heading_rad));
  // How far the turns move a line of the query, by its range, and the shifts at most.
  const auto turned =
      2 * std::sin(0.5f * static_cast<float>(o.turn_steps) * static_cast<float>(o.turn_step_rad));
  const float shifted = static_cast<float>(o.span_m) + cell;
  std::vector<Pairing> pairs;
  for (std::size_t i = 0; i < query.size(); ++i) {
    const PlanUpright& q = query[i];
    const float x = x0 + c * q.x_m - s * q.y_m, y = y0 + s * q.x_m + c * q.y_m;
    const float reach = shifted + turned * std::sqrt(q.x_m * q.x_m + q.y_m * q.y_m);
    for (const PlanUpright& n : node) {
      if (std::abs(n.x_m - x) > reach || std::abs(n.y_m - y) > reach) continue;
      if (!heights_agree(q, n)) continue;
      pairs.push_back({static_cast<int>(i), q.x_m / cell, q.y_m / cell, (n.x_m - x0) / cell,
                       (n.y_m - y0) / cell, 1 / (1 + (q.sigma_m + n.sigma_m) / blur_m)});
    }
  }
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
  constexpr float share = 0.3f;
  const float common = std::min(a.high_m, b.high_m) - std::max(a.low_m, b.low_m);
  return common >= share * std::min(a.high_m - a.low_m, b.high_m - b.low_m);
}

std::vector<VotePeak> vote(std::span<const PlanUpright> query,
                           std::span<const PlanUpright> node,
                           const Pose2D& around,
                           const VoteOptions& o) {
  const std::vector<Pairing> pairs = pairings(query, node, around, o);
  const int half = static_cast<int>(std::lround(o.span_m / o.cell_m)), side = 2 * half + 3;
  std::vector<float> votes;
  std::vector<int> last;  // line that voted for a cell: each counts once
  std::vector<Cell> found;
  for (int turn = -o.turn_steps; turn <= o.turn_steps; ++turn) {
    const double angle = around.heading_rad + turn * o.turn_step_rad;
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    votes.assign(static_cast<std::size_t>(side) * side, 0.0f);
    last.assign(votes.size(), -1);
    const float most = static_cast<float>(half) + 0.5f;
    for (const Pairing& p : pairs) {
      const float x = p.node_x - (c * p.query_x - s * p.query_y);
      const float y = p.node_y - (s * p.query_x + c * p.query_y);
      if (!(std::abs(x) < most && std::abs(y) < most)) continue;
      const float first = static_cast<float>(half) + 1.5f;  // above 0.5 with x and y
      const int column = static_cast<int>(x + first), row = static_cast<int>(y + first);
      const std::size_t at = static_cast<std::size_t>(row) * side + column;
      if (std::exchange(last[at], p.line) != p.line) votes[at] += p.weight;
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
  const std::size_t sorted = std::min(most_cells, found.size());
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(sorted), found.end(),
                    [](const Cell& a, const Cell& b) {
                      return std::tie(b.votes, a.turn, a.y, a.x) <
                             std::tie(a.votes, b.turn, b.y, b.x);
                    });
  found.resize(sorted);
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
