// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/search/floor_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "localise/place.h"
#include "localise/topological_map.h"
#include "localise/verification/floor_plan_votes.h"

namespace vernier::localise::internal {

namespace {

constexpr float cell_m = 0.25f;
constexpr int headings = 72;     ///< 5 degrees
constexpr float reach_m = 1.5f;  ///< of poses from a node
constexpr std::size_t most_poses = 40;
constexpr float furthest_m = 12;  ///< of a line from the robot

/// The vertical lines of all nodes in the world frame, those recorded from several nodes once.
std::vector<PlanUpright> world_uprights(const TopologicalMap& map) {
  constexpr float same_m = 0.12f, bucket_m = 0.25f;
  std::vector<PlanUpright> uprights;
  std::unordered_map<std::uint64_t, std::vector<int>> buckets;
  const auto bucket = [&](float x, float y, int dx, int dy) {
    const auto index = [&](float m, int d) {
      return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(m / bucket_m)) + d);
    };
    return static_cast<std::uint64_t>(index(x, dx)) << 32 | index(y, dy);
  };
  for (const MapNode& node : map.nodes) {
    for (PlanUpright u : plan_uprights(node.view.lines)) {
      const Pose2D at = compose(node.pose, {u.x_m, u.y_m, 0});
      u.x_m = static_cast<float>(at.x_m);
      u.y_m = static_cast<float>(at.y_m);
      bool is_known = false;
      for (int dx = -1; dx <= 1 && !is_known; ++dx) {
        for (int dy = -1; dy <= 1 && !is_known; ++dy) {
          const auto found = buckets.find(bucket(u.x_m, u.y_m, dx, dy));
          if (found == buckets.end()) continue;
          for (const int i : found->second) {
            PlanUpright& k = uprights[i];
            if (std::hypot(k.x_m - u.x_m, k.y_m - u.y_m) > same_m || !heights_agree(k, u)) continue;
            k.low_m = std::min(k.low_m, u.low_m);
            k.high_m = std::max(k.high_m, u.high_m);
            is_known = true;
            break;
          }
        }
      }
      if (is_known) continue;
      buckets[bucket(u.x_m, u.y_m, 0, 0)].push_back(static_cast<int>(uprights.size()));
      uprights.push_back(u);
    }
  }
  return uprights;
}

struct Peak {
  float votes;
  int heading, x, y;
};

}  // namespace

FloorSearch::FloorSearch(const TopologicalMap& map) : uprights_(world_uprights(map)) {
  constexpr double most_side_m = 2000;
  if (map.nodes.empty()) return;
  double left = std::numeric_limits<double>::max(), low = left, right = -left, high = -left;
  for (const MapNode& node : map.nodes) {
    left = std::min(left, node.pose.x_m);
    right = std::max(right, node.pose.x_m);
    low = std::min(low, node.pose.y_m);
    high = std::max(high, node.pose.y_m);
  }
  if (!(right - left < most_side_m && high - low < most_side_m))
    return;  // ranking alone finds these
  left_m_ = static_cast<float>(left) - reach_m;
  low_m_ = static_cast<float>(low) - reach_m;
  columns_ = static_cast<int>((right - left + 2 * reach_m) / cell_m) + 3;
  rows_ = static_cast<int>((high - low + 2 * reach_m) / cell_m) + 3;
  covered_.assign(static_cast<std::size_t>(columns_) * rows_, 0);
  const int reach = static_cast<int>(reach_m / cell_m);
  for (const MapNode& node : map.nodes) {
    const int x = static_cast<int>((static_cast<float>(node.pose.x_m) - left_m_) / cell_m);
    const int y = static_cast<int>((static_cast<float>(node.pose.y_m) - low_m_) / cell_m);
    for (int j = std::max(1, y - reach); j <= std::min(rows_ - 2, y + reach); ++j) {
      for (int i = std::max(1, x - reach); i <= std::min(columns_ - 2, x + reach); ++i) {
        if ((i - x) * (i - x) + (j - y) * (j - y) <= reach * reach) {
          covered_[static_cast<std::size_t>(j) * columns_ + i] = 1;
        }
      }
    }
  }
}

std::vector<Pose2D> FloorSearch::poses(std::span<const PlanUpright> query) const {
  if (covered_.empty() || query.empty()) return {};
  // Pairs of lines that may be the same, by line of the query.
  std::vector<std::vector<int>> partners(query.size());
  for (std::size_t q = 0; q < query.size(); ++q) {
    for (std::size_t i = 0; i < uprights_.size(); ++i) {
      if (heights_agree(query[q], uprights_[i])) partners[q].push_back(static_cast<int>(i));
    }
  }
  constexpr float blur_m = 0.15f;
  std::vector<float> votes(covered_.size());
  std::vector<Peak> peaks;
  for (int h = 0; h < headings; ++h) {
    const double angle = 2 * std::numbers::pi * h / headings;
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    std::fill(votes.begin(), votes.end(), 0.0f);
    for (std::size_t q = 0; q < query.size(); ++q) {
      const float dx = c * query[q].x_m - s * query[q].y_m + left_m_;
      const float dy = s * query[q].x_m + c * query[q].y_m + low_m_;
      const float weight = 1 / (1 + query[q].sigma_m / blur_m);
      for (const int i : partners[q]) {
        const float x = (uprights_[i].x_m - dx) / cell_m, y = (uprights_[i].y_m - dy) / cell_m;
        if (!(x >= 1 && y >= 1 && x < static_cast<float>(columns_ - 1) &&
              y < static_cast<float>(rows_ - 1))) {
          continue;
        }
        votes[static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x)] += weight;
      }
    }
    for (int y = 1; y < rows_ - 1; ++y) {
      for (int x = 1; x < columns_ - 1; ++x) {
        const std::size_t at = static_cast<std::size_t>(y) * columns_ + x;
        if (!covered_[at] || votes[at] == 0) continue;
        const float* v = &votes[at];
        const float sum =
            v[0] + 0.7f * (v[1] + v[-1] + v[columns_] + v[-columns_]) +
            0.4f * (v[columns_ + 1] + v[columns_ - 1] + v[-columns_ + 1] + v[-columns_ - 1]);
        peaks.push_back({sum, h, x, y});
      }
    }
  }
  constexpr std::size_t most_peaks = 2000;
  const auto better = [](const Peak& a, const Peak& b) {
    return std::tie(b.votes, a.heading, a.y, a.x) < std::tie(a.votes, b.heading, b.y, b.x);
  };
  const std::size_t sorted = std::min(most_peaks, peaks.size());
  std::partial_sort(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(sorted), peaks.end(),
                    better);
  peaks.resize(sorted);
  std::vector<Peak> kept;
  std::vector<Pose2D> poses;
  for (const Peak& p : peaks) {
    if (poses.size() >= most_poses) break;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Peak& k) {
      const int turn = std::abs(k.heading - p.heading);
      return std::abs(k.x - p.x) <= 2 && std::abs(k.y - p.y) <= 2 &&
             std::min(turn, headings - turn) <= 2;
    });
    if (!is_new) continue;
    kept.push_back(p);
    poses.push_back({left_m_ + (static_cast<float>(p.x) + 0.5) * cell_m,
                     low_m_ + (static_cast<float>(p.y) + 0.5) * cell_m,
                     2 * std::numbers::pi * p.heading / headings});
  }
  return poses;
}

}  // namespace vernier::localise::internal
