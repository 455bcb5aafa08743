// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "localise/place.h"

namespace vernier::localise::internal {
namespace {

/// Maximum height difference of matching level lines.
constexpr double level_height_m = 0.15;

/// A vertical line on the floor plan.
struct Upright {
  Eigen::Vector2d at_m;
  double low_m, high_m, sigma_m;
};

/// A level line on the floor plan.
struct Level {
  Eigen::Vector2d a_m, b_m, direction;
  double length_m, height_m, sigma_m;
};

void check(const AlignmentOptions& o) {
  constexpr double most_steps = 1000;  // the translation votes fill a square of them
  const auto good = [](double most, double step) {
    return step > 0 && most >= 0 && most / step <= most_steps;
  };
  if (!good(o.max_turn_rad, o.turn_step_rad) || !good(o.max_shift_m, o.shift_step_m) ||
      !(o.position_sigma_m > 0)) {
    throw Error("alignment options",
                "turn and shift steps and the sigma must be above 0, with at most 1000 steps to "
                "either side",
                "");
  }
}

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

/// Agreement of a vertical line at `at` with one of the node, in [0, 1].
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

/// The same for level lines, the query's already transformed.
double agreement(const Level& query, const Level& node, double position_sigma_m) {
  const double sine =
      std::abs(query.direction.x() * node.direction.y() - query.direction.y() * node.direction.x());
  if (sine > 0.35 || std::abs(query.height_m - node.height_m) > level_height_m) return 0;
  const Eigen::Vector2d between = 0.5 * (node.a_m + node.b_m) - query.a_m;
  const double along = between.dot(query.direction);
  if (along < -0.5 * node.length_m || along > query.length_m + 0.5 * node.length_m) return 0;
  const double across = between.x() * query.direction.y() - between.y() * query.direction.x();
  const double sigma = position_sigma_m + 0.5 * (query.sigma_m + node.sigma_m);
  return std::exp(-0.5 * across * across / (sigma * sigma) - 0.5 * sine * sine / 0.02);
}

/// For every query line, the node lines that it may match while the pose is refined: those near it
/// at the start.
class Neighbours {
 public:
  Neighbours(const Plan& query, const Plan& node, const Pose2D& T, double position_sigma_m)
      : query_(query), node_(node), position_sigma_m_(position_sigma_m) {
    constexpr double travel_m = 0.5;  // refinement seldom moves farther; lines beyond are ignored
    const Eigen::Rotation2Dd R(T.heading_rad);
    const Eigen::Vector2d t(T.x_m, T.y_m);
    uprights_.resize(query.uprights.size());
    for (std::size_t i = 0; i < query.uprights.size(); ++i) {
      const Upright& q = query.uprights[i];
      const Eigen::Vector2d at = R * q.at_m + t;
      for (std::size_t k = 0; k < node.uprights.size(); ++k) {
        const double sigma = position_sigma_m + 0.7 * (q.sigma_m + node.uprights[k].sigma_m);
        const double reach = travel_m + 3 * sigma;
        if ((node.uprights[k].at_m - at).squaredNorm() < reach * reach) {
          uprights_[i].push_back(static_cast<int>(k));
        }
      }
    }
    levels_.resize(query.levels.size());
    for (std::size_t i = 0; i < query.levels.size(); ++i) {
      const Level& q = query.levels[i];
      const Eigen::Vector2d middle = R * (0.5 * (q.a_m + q.b_m)) + t;
      for (std::size_t k = 0; k < node.levels.size(); ++k) {
        const Level& n = node.levels[k];
        const double sigma = position_sigma_m + 0.5 * (q.sigma_m + n.sigma_m);
        const double reach = travel_m + 0.5 * (q.length_m + 2 * n.length_m) + 3 * sigma;
        if (std::abs(q.height_m - n.height_m) <= level_height_m &&
            (0.5 * (n.a_m + n.b_m) - middle).squaredNorm() < reach * reach) {
          levels_[i].push_back(static_cast<int>(k));
        }
      }
    }
  }

  /// Sum over the query's lines of their best agreement with a node line.
  double score(const Pose2D& T) const {
    double sum = 0;
    visit_best(T, [&](double agreed, int) { sum += agreed; });
    return sum;
  }

  /// The smaller of that sum and its counterpart over the node's lines.
  double mutual_score(const Pose2D& T) const {
    std::vector<double> of_node(node_.uprights.size() + node_.levels.size(), 0.0);
    double of_query = 0;
    visit_best(T, [&](double agreed, int line) {
      of_query += agreed;
      if (line >= 0) of_node[line] = std::max(of_node[line], agreed);
    });
    return std::min(of_query, std::accumulate(of_node.begin(), of_node.end(), 0.0));
  }

 private:
  /// Calls visit(agreement, node line) with every query line's best partner, -1 if none agrees;
  /// indices of the node's level lines follow those of its vertical lines.
  template <class Visit>
  void visit_best(const Pose2D& T, Visit visit) const {
    const Eigen::Rotation2Dd R(T.heading_rad);
    const Eigen::Vector2d t(T.x_m, T.y_m);
    const auto best_of = [&](const std::vector<int>& lines, int offset, auto consistency_with) {
      double best = 0;
      int which = -1;
      for (const int k : lines) {
        const double agreed = consistency_with(k);
        if (agreed > best) {
          best = agreed;
          which = offset + k;
        }
      }
      visit(best, which);
    };
    for (std::size_t i = 0; i < uprights_.size(); ++i) {
      const Eigen::Vector2d at = R * query_.uprights[i].at_m + t;
      best_of(uprights_[i], 0, [&](int k) {
        return agreement(query_.uprights[i], at, node_.uprights[k], position_sigma_m_);
      });
    }
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const Level& q = query_.levels[i];
      const Level moved{R * q.a_m + t, R * q.b_m + t, R * q.direction,
                        q.length_m,    q.height_m,    q.sigma_m};
      best_of(levels_[i], static_cast<int>(node_.uprights.size()),
              [&](int k) { return agreement(moved, node_.levels[k], position_sigma_m_); });
    }
  }

  const Plan &query_, &node_;
  double position_sigma_m_;
  std::vector<std::vector<int>> uprights_, levels_;
};

/// Translation votes of pairs of vertical lines, for one rotation.
class ShiftVotes {
 public:
  ShiftVotes(const Plan& query, const Plan& node, const AlignmentOptions& o)
      : options_(o),
        half_(static_cast<int>(std::round(o.max_shift_m / o.shift_step_m))),
        stride_(2 * half_ + 3),
        votes_(static_cast<std::size_t>(stride_) * stride_) {
    for (const Upright& q : query.uprights) {
      for (const Upright& n : node.uprights) {
        const double shorter = std::min(q.high_m - q.low_m, n.high_m - n.low_m);
        if (overlap(q, n) < 0.3 * shorter) continue;
        pairs_.push_back(
            {q.at_m, n.at_m, static_cast<float>(1 / (1 + (q.sigma_m + n.sigma_m) / 0.15))});
      }
    }
  }

  /// The translation with the most votes at this rotation, and its votes; neighbouring cells count
  /// half.
  std::pair<Eigen::Vector2d, double> best(double turn) {
    std::fill(votes_.begin(), votes_.end(), 0.0f);
    const double c = std::cos(turn) / options_.shift_step_m;
    const double s = std::sin(turn) / options_.shift_step_m;
    const double scale = 1 / options_.shift_step_m;
    const double limit = half_ + 0.5;
    for (const Pair& p : pairs_) {
      const double x = scale * p.node.x() - (c * p.query.x() - s * p.query.y());
      const double y = scale * p.node.y() - (s * p.query.x() + c * p.query.y());
      if (!(std::abs(x) < limit && std::abs(y) < limit)) continue;
      votes_[cell(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)))] += p.weight;
    }
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    double most = 0;
    for (int y = -half_; y <= half_; ++y) {
      for (int x = -half_; x <= half_; ++x) {
        float sum = votes_[cell(x, y)];
        for (int dy = -1; dy <= 1; ++dy) {
          const float* row = &votes_[cell(x - 1, y + dy)];
          sum += row[0] + row[1] + row[2];
        }
        if (0.5 * sum > most) {
          most = 0.5 * sum;
          shift = Eigen::Vector2d(x, y) * options_.shift_step_m;
        }
      }
    }
    return {shift, most};
  }

 private:
  struct Pair {
    Eigen::Vector2d query, node;
    float weight;
  };
  /// Cells have an empty border of one all around.
  std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>(y + half_ + 1) * stride_ + x + half_ + 1;
  }

  AlignmentOptions options_;
  int half_, stride_;
  std::vector<float> votes_;
  std::vector<Pair> pairs_;
};

/// Coordinate ascent with halving steps.
Pose2D ascend(const Neighbours& lines, Pose2D T) {
  std::array<double, 3> step{0.1, 0.1, 0.03};
  double best = lines.score(T);
  for (int round = 0; round < 14; ++round) {
    bool better = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        Pose2D trial = T;
        (axis == 0 ? trial.x_m : axis == 1 ? trial.y_m : trial.heading_rad) += sign * step[axis];
        const double value = lines.score(trial);
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
  check(options);
  const Plan query = plan_of(query_view), node = plan_of(node_view);
  ShiftVotes votes(query, node, options);
  Pose2D start;
  double most = 0;
  const int turns = static_cast<int>(std::round(options.max_turn_rad / options.turn_step_rad));
  for (int i = -turns; i <= turns; ++i) {
    const double turn = i * options.turn_step_rad;
    const auto [shift, count] = votes.best(turn);
    if (count > most) {
      most = count;
      start = {shift.x(), shift.y(), turn};
    }
  }
  Alignment result;
  const Neighbours lines(query, node, start, options.position_sigma_m);
  result.query_in_node = ascend(lines, start);
  // The offset keeps small views from high scores by chance.
  result.score = lines.mutual_score(result.query_in_node) /
                 std::sqrt((query.count() + 5) * (node.count() + 5));
  return result;
}

}  // namespace vernier::localise::internal
