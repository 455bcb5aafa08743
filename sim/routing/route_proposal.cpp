// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/routing/route_proposal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/routing/floor_plan.h"
#include "sim/world.h"

namespace vernier::sim::internal {

namespace {

constexpr double wished_clearance_m = 0.5, least_end_clearance_m = 0.3;
constexpr double new_leg_m = 2.5, near_m = 2;
constexpr float unreached = std::numeric_limits<float>::infinity();

struct Cell {
  int x = -1, y = -1;
  bool operator==(const Cell& other) const { return x == other.x && y == other.y; }
};

/// Shortest ways from a growing set of cells.
class Ways {
 public:
  explicit Ways(const FloorPlan& plan)
      : plan_(plan),
        cost_(static_cast<std::size_t>(plan.width()) * static_cast<std::size_t>(plan.height()),
              unreached),
        before_(cost_.size()) {}

  /// Adds cells, and shortens the ways to all others.
  void start_from(const std::vector<Cell>& cells) {
    std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
    for (const Cell& cell : cells) {
      cost(cell) = 0;
      before(cell) = cell;
      open.push({0, cell.y, cell.x});
    }
    while (!open.empty()) {
      const auto [so_far, y, x] = open.top();
      open.pop();
      const Cell here{x, y};
      if (so_far > cost(here)) continue;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Cell next{x + dx, y + dy};
          if ((dx == 0 && dy == 0) || !plan_.has(next.x, next.y) || !plan_.inside(next.x, next.y))
            continue;
          // not diagonally past a corner
          if (!plan_.inside(x + dx, y) || !plan_.inside(x, y + dy)) continue;
          const float now = so_far + step_cost(next, dx != 0 && dy != 0);
          if (now >= cost(next)) continue;
          cost(next) = now;
          before(next) = here;
          open.push({now, next.y, next.x});
        }
      }
    }
  }

  /// The reached cell furthest away at which a leg may end; none without one.
  Cell furthest() const {
    Cell best;
    float most = -1;
    for (int y = 0; y < plan_.height(); ++y) {
      for (int x = 0; x < plan_.width(); ++x) {
        const float here = cost_[plan_.index(x, y)];
        if (here == unreached || here <= most || plan_.clearance_m(x, y) < least_end_clearance_m)
          continue;
        most = here;
        best = {x, y};
      }
    }
    return best;
  }

  float cost_to(const Cell& cell) const { return cost_[plan_.index(cell.x, cell.y)]; }

  /// From where it starts to a cell.
  std::vector<Cell> way_to(Cell cell) const {
    std::vector<Cell> way{cell};
    for (;;) {
      const Cell previous = before_[plan_.index(cell.x, cell.y)];
      if (previous == cell) break;
      way.push_back(cell = previous);
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

 private:
  struct Open {
    float cost;
    int y, x;
    bool operator>(const Open& other) const {
      return std::tie(cost, y, x) > std::tie(other.cost, other.y, other.x);
    }
  };
  float& cost(const Cell& cell) { return cost_[plan_.index(cell.x, cell.y)]; }
  Cell& before(const Cell& cell) { return before_[plan_.index(cell.x, cell.y)]; }

  /// Metres, up to five times as many close to what is in the way.
  float step_cost(const Cell& to, bool is_slanted) const {
    const double lacking = std::max(0.0, 1 - plan_.clearance_m(to.x, to.y) / wished_clearance_m);
    const double length = FloorPlan::cell_m * (is_slanted ? std::sqrt(2.0) : 1.0);
    return static_cast<float>(length * (1 + 4 * lacking));
  }

  const FloorPlan& plan_;
  std::vector<float> cost_;
  std::vector<Cell> before_;
};

/// Whether the straight line between two cells keeps the clearance.
bool keeps(const FloorPlan& plan, const Cell& a, const Cell& b, double clearance_m) {
  const int steps = 2 * std::max({std::abs(b.x - a.x), std::abs(b.y - a.y), 1});
  for (int k = 0; k <= steps; ++k) {
    const int x = static_cast<int>(std::lround(a.x + (b.x - a.x) * static_cast<double>(k) / steps));
    const int y = static_cast<int>(std::lround(a.y + (b.y - a.y) * static_cast<double>(k) / steps));
    if (!plan.has(x, y) || !plan.inside(x, y) || plan.clearance_m(x, y) < clearance_m) return false;
  }
  return true;
}

/// A way as few straight pieces, each with the clearance of the part that it replaces, or 0.3 m.
RouteLeg straightened(const FloorPlan& plan, const std::vector<Cell>& way) {
  constexpr std::size_t furthest = 300;
  RouteLeg leg;
  const auto add = [&](const Cell& cell) {
    const Eigen::Vector2d at = plan.centre_m(cell.x, cell.y);
    leg.points_m.emplace_back(std::round(at.x() * 100) / 100, std::round(at.y() * 100) / 100);
  };
  add(way[0]);
  for (std::size_t from = 0; from + 1 < way.size();) {
    std::size_t to = from + 1;
    double clearance = 1;
    for (std::size_t i = from; i < std::min(way.size(), from + furthest); ++i) {
      clearance =
          std::min({clearance, plan.clearance_m(way[i].x, way[i].y), least_end_clearance_m});
      if (i > to && keeps(plan, way[from], way[i], clearance)) to = i;
    }
    add(way[to]);
    from = to;
  }
  return leg;
}

}  // namespace

RouteProposal propose_route(const FloorPlan& plan, std::size_t most_legs) {
  RouteProposal proposal;
  proposal.floor_m2 = plan.inside_m2();
  proposal.other_m2 = plan.other_m2();
  proposal.level_m2 = plan.level_m2();
  proposal.open_m2 = plan.open_m2();
  proposal.is_open = plan.is_open();
  proposal.gap_m = plan.gap_m();
  Cell any;
  for (int y = 0; y < plan.height() && any.x < 0; ++y) {
    for (int x = 0; x < plan.width() && any.x < 0; ++x) {
      if (plan.inside(x, y) && plan.clearance_m(x, y) >= least_end_clearance_m) any = {x, y};
    }
  }
  if (any.x < 0) return proposal;
  const auto furthest_from = [&](const Cell& cell) {
    Ways ways(plan);
    ways.start_from({cell});
    return ways.furthest();
  };
  const Cell first = furthest_from(any);
  Ways trunk(plan);
  trunk.start_from({first});
  std::vector<Cell> way = trunk.way_to(trunk.furthest());
  Ways ways(plan);
  for (;;) {
    if (way.size() > 1) proposal.route.push_back(straightened(plan, way));
    ways.start_from(way);
    const Cell next = ways.furthest();
    if (next.x < 0 || ways.cost_to(next) < new_leg_m) break;
    proposal.is_cut_short = proposal.route.size() == most_legs;
    if (proposal.is_cut_short) break;
    way = ways.way_to(next);
  }
  std::size_t near = 0;
  for (int y = 0; y < plan.height(); ++y) {
    for (int x = 0; x < plan.width(); ++x) near += ways.cost_to({x, y}) <= near_m;
  }
  proposal.near_m2 = static_cast<double>(near) * FloorPlan::cell_m * FloorPlan::cell_m;
  return proposal;
}

}  // namespace vernier::sim::internal
