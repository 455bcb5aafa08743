// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace vernier {
namespace {

/// An upright line on the plan.
struct Upright {
  Eigen::Vector2d at_m;
  double low_m, high_m, sigma_m;
};

/// A level line on the plan.
struct Level {
  Eigen::Vector2d a_m, b_m, direction;
  double length_m, height_m, sigma_m;
};

struct Plan {
  std::vector<Upright> uprights;
  std::vector<Level> levels;
  double count() const { return static_cast<double>(uprights.size() + levels.size()); }
};

Plan plan_of(const PlaceView& view) {
  Plan plan;
  for (const PlaceLine& line : view.lines) {
    const double low = std::min(line.a_m.z(), line.b_m.z());
    const double high = std::max(line.a_m.z(), line.b_m.z());
    const Eigen::Vector2d a = line.a_m.head<2>(), b = line.b_m.head<2>();
    if (line.kind == LineKind::vertical) {
      plan.uprights.push_back({0.5 * (a + b), low, high, line.sigma_m});
    } else if (line.kind == LineKind::level && (b - a).norm() > 0.2) {
      plan.levels.push_back(
          {a, b, (b - a).normalized(), (b - a).norm(), 0.5 * (low + high), line.sigma_m});
    }
  }
  return plan;
}

double overlap(const Upright& p, const Upright& q) {
  return std::min(p.high_m, q.high_m) - std::max(p.low_m, q.low_m);
}

/// How well an upright line at `at` agrees with one of the node, in [0, 1].
double agreement(const Upright& query,
                 const Eigen::Vector2d& at,
                 const Upright& node,
                 double position_sigma_m) {
  const double sigma = position_sigma_m + 0.7 * (query.sigma_m + node.sigma_m);
  const double d2 = (node.at_m - at).squaredNorm();
  if (d2 > 9 * sigma * sigma) return 0;
  const double joint = std::max(query.high_m, node.high_m) - std::min(query.low_m, node.low_m);
  const double common = std::max(0.0, overlap(query, node)) / std::max(joint, 1e-9);
  return (0.3 + 0.7 * common) * std::exp(-0.5 * d2 / (sigma * sigma));
}

/// The same for level lines, the query's already turned and shifted.
double agreement(const Level& query, const Level& node, double position_sigma_m) {
  const double sine =
      std::abs(query.direction.x() * node.direction.y() - query.direction.y() * node.direction.x());
  if (sine > 0.35 || std::abs(query.height_m - node.height_m) > 0.15) return 0;
  const Eigen::Vector2d between = 0.5 * (node.a_m + node.b_m) - query.a_m;
  const double along = between.dot(query.direction);
  if (along < -0.5 * node.length_m || along > query.length_m + 0.5 * node.length_m) return 0;
  const double across = between.x() * query.direction.y() - between.y() * query.direction.x();
  const double sigma = position_sigma_m + 0.5 * (query.sigma_m + node.sigma_m);
  return std::exp(-0.5 * across * across / (sigma * sigma) - 0.5 * sine * sine / 0.02);
}

double score(const Plan& query, const Plan& node, const PlanePose& T, double position_sigma_m) {
  const Eigen::Rotation2Dd R(T.heading_rad);
  const Eigen::Vector2d t(T.x_m, T.y_m);
  double sum = 0;
  for (const Upright& q : query.uprights) {
    const Eigen::Vector2d at = R * q.at_m + t;
    double best = 0;
    for (const Upright& n : node.uprights) {
      best = std::max(best, agreement(q, at, n, position_sigma_m));
    }
    sum += best;
  }
  for (const Level& q : query.levels) {
    const Level moved{R * q.a_m + t, R * q.b_m + t, R * q.direction,
                      q.length_m,    q.height_m,    q.sigma_m};
    double best = 0;
    for (const Level& n : node.levels) best = std::max(best, agreement(moved, n, position_sigma_m));
    sum += best;
  }
  return sum;
}

/// Votes of pairs of upright lines for the shift, at one turn.
class ShiftVotes {
 public:
  explicit ShiftVotes(const AlignmentOptions& o)
      : options_(o),
        side_(2 * static_cast<int>(std::round(o.max_shift_m / o.shift_step_m)) + 1),
        votes_(static_cast<std::size_t>(side_) * side_) {}

  /// The shift with most votes at this turn, and its votes.
  std::pair<Eigen::Vector2d, double> best(const Plan& query, const Plan& node, double turn) {
    std::fill(votes_.begin(), votes_.end(), 0.0f);
    const Eigen::Rotation2Dd R(turn);
    for (const Upright& q : query.uprights) {
      const Eigen::Vector2d at = R * q.at_m;
      for (const Upright& n : node.uprights) {
        const double shorter = std::min(q.high_m - q.low_m, n.high_m - n.low_m);
        if (overlap(q, n) < 0.3 * shorter) continue;
        add(n.at_m - at, 1 / (1 + (q.sigma_m + n.sigma_m) / 0.15));
      }
    }
    const auto top = std::max_element(votes_.begin(), votes_.end()) - votes_.begin();
    const double half = side_ / 2;
    return {Eigen::Vector2d(top % side_ - half, top / side_ - half) * options_.shift_step_m,
            votes_[top]};
  }

 private:
  void add(const Eigen::Vector2d& shift, double weight) {
    const Eigen::Vector2d cell = shift / options_.shift_step_m;
    const int x = static_cast<int>(std::lround(cell.x())) + side_ / 2;
    const int y = static_cast<int>(std::lround(cell.y())) + side_ / 2;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= side_ || y + dy >= side_) continue;
        votes_[(y + dy) * side_ + x + dx] += static_cast<float>(weight * (dx || dy ? 0.5 : 1.0));
      }
    }
  }

  AlignmentOptions options_;
  int side_;
  std::vector<float> votes_;
};

/// Coordinate ascent with halving steps.
PlanePose ascend(
    const Plan& query, const Plan& node, PlanePose T, double position_sigma_m, double& best) {
  std::array<double, 3> step{0.1, 0.1, 0.03};
  best = score(query, node, T, position_sigma_m);
  for (int round = 0; round < 14; ++round) {
    bool better = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        PlanePose trial = T;
        (axis == 0 ? trial.x_m : axis == 1 ? trial.y_m : trial.heading_rad) += sign * step[axis];
        const double value = score(query, node, trial, position_sigma_m);
        if (value > best) {
          best = value;
          T = trial;
          better = true;
        }
      }
    }
    if (!better) {
      for (double& s : step) s *= 0.5;
    }
  }
  return T;
}

}  // namespace

Alignment align(const PlaceView& query_view,
                const PlaceView& node_view,
                const AlignmentOptions& options) {
  const Plan query = plan_of(query_view), node = plan_of(node_view);
  ShiftVotes votes(options);
  PlanePose start;
  double most = 0;
  const int turns = static_cast<int>(std::round(options.max_turn_rad / options.turn_step_rad));
  for (int i = -turns; i <= turns; ++i) {
    const double turn = i * options.turn_step_rad;
    const auto [shift, count] = votes.best(query, node, turn);
    if (count > most) {
      most = count;
      start = {shift.x(), shift.y(), turn};
    }
  }
  Alignment result;
  double matched = 0;
  result.query_in_node = ascend(query, node, start, options.position_sigma_m, matched);
  // A few lines more on both sides keep small views from scoring by chance.
  result.score = matched / std::sqrt((query.count() + 5) * (node.count() + 5));
  return result;
}

}  // namespace vernier
