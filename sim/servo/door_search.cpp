// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/servo/door_search.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/servo/goal_alignment.h"
#include "sim/servo/stereo_line.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace stereo;

namespace {

/// rho in both images of lines that are more upright than level, by that in the left one. The right
/// image is that of a camera parallel to the left one: its own may be rolled.
class UprightLines {
 public:
  UprightLines(std::span<const SeenLine> seen, const Pose& T_right_left)
      : R_left_right_(T_right_left.R.transpose()) {
    for (const SeenLine& line : seen) {
      if (const auto entry = entry_of(line.image)) entries_.push_back(*entry);
    }
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return std::pair(a.left, a.right) < std::pair(b.left, b.right);
    });
  }

  /// Between 0 and 1: how well some line agrees with this one.
  double agreement(const StereoLine& line, double reach) const {
    constexpr double parallel = 0.1, disparity_share = 0.6;
    const auto wanted = entry_of(line);
    if (!wanted) return 0;
    const auto before = [](const Entry& e, double left) { return e.left < left; };
    double best = 0;
    for (auto e = std::lower_bound(entries_.begin(), entries_.end(), wanted->left - reach, before);
         e != entries_.end() && e->left < wanted->left + reach; ++e) {
      const double off = e->left - wanted->left;
      if (std::abs(e->tilt - wanted->tilt) > parallel) continue;
      if (std::abs(e->right - wanted->right - off) > disparity_share * reach) continue;
      best = std::max(best, 1 - std::abs(off) / reach);
    }
    return best;
  }

 private:
  struct Entry {
    double left, right, tilt;
  };

  std::optional<Entry> entry_of(const StereoLine& line) const {
    constexpr double least_cosine = 0.7;
    const ImageLine parallel = R_left_right_ * line.right;
    const double l = line.left.x(), r = parallel.x();
    if (std::abs(l) < least_cosine || std::abs(r) < least_cosine * parallel.head<2>().norm()) {
      return std::nullopt;
    }
    return Entry{-line.left.z() / l, -parallel.z() / r, line.left.y() / l};
  }

  Eigen::Matrix3d R_left_right_;
  std::vector<Entry> entries_;
};

struct GoalHypothesis {
  double score;
  Pose2D goal;
};

std::vector<GoalHypothesis> lattice_scores(const DesiredView& desired,
                                           std::span<const SeenLine> seen,
                                           const SearchRange& range) {
  constexpr double back_step_m = 0.1, aside_step_m = 0.06, turn_step_rad = 0.0175, reach_px = 12;
  const UprightLines lines(seen, desired.T_right_left);
  const auto steps = [](double from, double to, double step) {
    return 1 + static_cast<int>(std::ceil((to - from) / step));
  };
  std::vector<GoalHypothesis> all;
  const int backs = steps(range.nearest_back_m, range.farthest_back_m, back_step_m);
  const int asides = steps(-range.aside_m, range.aside_m, aside_step_m);
  const int turns = steps(-range.turned_rad, range.turned_rad, turn_step_rad);
  for (int back = 0; back < backs; ++back) {
    for (int aside = 0; aside < asides; ++aside) {
      for (int turn = 0; turn < turns; ++turn) {
        const Pose2D here{-range.nearest_back_m - back * back_step_m,
                          -range.aside_m + aside * aside_step_m,
                          -range.turned_rad + turn * turn_step_rad};
        const Pose2D goal = relative({}, here);
        double score = 0;
        for (const SpaceLine& line : lines_at(desired, goal)) {
          score +=
              lines.agreement(image_of(line, desired.T_right_left), reach_px / desired.focal_px);
        }
        all.push_back({score, goal});
      }
    }
  }
  return all;
}

/// Difference of rho in size, as difference() has it: most lines need no more.
double rho_apart(const ImageLine& a, const ImageLine& b) {
  return std::abs(a.head<2>().dot(b.head<2>()) < 0 ? a.z() + b.z() : a.z() - b.z());
}

/// The first `count` that are not beside an earlier one.
std::vector<GoalHypothesis> apart(std::span<const GoalHypothesis> all, std::size_t count) {
  constexpr double beside_m = 0.11, beside_rad = 0.027;
  std::vector<GoalHypothesis> kept;
  for (const GoalHypothesis& h : all) {
    if (kept.size() == count) break;
    const bool beside = std::any_of(kept.begin(), kept.end(), [&](const GoalHypothesis& k) {
      return distance_m(h.goal, k.goal) < beside_m &&
             std::abs(h.goal.heading_rad - k.goal.heading_rad) < beside_rad;
    });
    if (!beside) kept.push_back(h);
  }
  return kept;
}

/// Closer and closer matches of the lines around a hypothesis, and how well they agree at last.
std::optional<GoalHypothesis> refined(const DesiredView& desired,
                                      std::span<const SeenLine> seen,
                                      const SearchRange& range,
                                      Pose2D goal) {
  constexpr double reach_px = 6;
  for (const double gate_px : {12., 9., 7.}) {
    const auto predicted = images_of(lines_at(desired, goal), desired.T_right_left);
    const auto fix = align_goal(desired, nearest_lines(desired, predicted, seen, gate_px), goal);
    if (!fix) return std::nullopt;
    goal = fix->goal;
  }
  const Pose2D here = relative({}, goal);
  const bool inside = -here.x_m > range.nearest_back_m && -here.x_m < range.farthest_back_m &&
                      std::abs(here.y_m) < range.aside_m &&
                      std::abs(here.heading_rad) < range.turned_rad;
  if (!inside) return std::nullopt;
  const auto predicted = images_of(lines_at(desired, goal), desired.T_right_left);
  double score = 0;
  for (const LineMatch& match : nearest_lines(desired, predicted, seen, reach_px)) {
    const Eigen::Vector4d d =
        difference(match.seen.image, predicted[static_cast<std::size_t>(match.line)]);
    score += 1 - desired.focal_px * std::max(std::abs(d[0]), std::abs(d[2])) / reach_px;
  }
  return GoalHypothesis{score, goal};
}

}  // namespace

std::vector<SeenLine> see_all(const Rig& told, std::span<const StereoSegment> segments) {
  std::vector<SeenLine> lines;
  for (const StereoSegment& segment : segments) {
    if (auto line = see(told, segment)) lines.push_back(std::move(*line));
  }
  return lines;
}

std::vector<LineMatch> nearest_lines(const DesiredView& desired,
                                     std::span<const StereoLine> predicted,
                                     std::span<const SeenLine> seen,
                                     double gate_px) {
  constexpr double short_px = 100;  // a line of this length counts as 1 px farther away
  std::vector<LineMatch> matches;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const SeenLine* nearest = nullptr;
    double least = 0;
    for (const SeenLine& line : seen) {
      if (!(rho_apart(line.image.left, predicted[i].left) <= gate_px / desired.focal_px)) continue;
      const Eigen::Vector4d d = difference(line.image, predicted[i]).cwiseAbs();
      const double half_px = line.length_px / 2;
      const double off_px =
          std::max(desired.focal_px * std::max(d[0], d[2]), half_px * std::max(d[1], d[3]));
      if (!(off_px <= gate_px)) continue;
      const double cost = off_px + short_px / std::max(1.0, line.length_px);
      if (nearest && cost >= least) continue;
      nearest = &line;
      least = cost;
    }
    if (nearest) matches.push_back({static_cast<int>(i), *nearest});
  }
  return matches;
}

std::vector<SpaceLine> lines_at(const DesiredView& desired, const Pose2D& goal) {
  const Pose T_here_goal = T_left_left({}, goal, desired.mount);
  std::vector<SpaceLine> lines;
  lines.reserve(desired.lines.size());
  for (const SeenLine& line : desired.lines) lines.push_back(moved(line.space, T_here_goal));
  return lines;
}

std::vector<StereoLine> images_of(std::span<const SpaceLine> lines, const Pose& T_right_left) {
  std::vector<StereoLine> images;
  images.reserve(lines.size());
  for (const SpaceLine& line : lines) images.push_back(image_of(line, T_right_left));
  return images;
}

std::optional<Pose2D> find_goal(const DesiredView& desired,
                                std::span<const SeenLine> seen,
                                const SearchRange& range) {
  constexpr std::size_t refined_ones = 20;
  constexpr double least_score = 2;
  std::vector<GoalHypothesis> all = lattice_scores(desired, seen, range);
  const auto better = [](const GoalHypothesis& a, const GoalHypothesis& b) {
    return a.score > b.score;
  };
  std::stable_sort(all.begin(), all.end(), better);
  std::optional<GoalHypothesis> best;
  for (const GoalHypothesis& hypothesis : apart(all, refined_ones)) {
    const auto result = refined(desired, seen, range, hypothesis.goal);
    if (result && (!best || better(*result, *best))) best = result;
  }
  if (!best || best->score < least_score) return std::nullopt;
  return best->goal;
}

}  // namespace vernier::sim::internal
