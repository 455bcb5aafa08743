// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/tone_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "calib/statistics/quantile.h"
#include "stereo/matching/edge_support.h"
#include "stereo/matching/side_levels.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

/// A level and the usual difference of the pairs around it.
struct Knot {
  double level = 0, difference = 0;
};

/// Mean of the middle half: of pairs a part of a pixel off, edges that rise and edges that fall
/// differ either way, and a median would take one side.
double middle_mean(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto quarter = static_cast<std::ptrdiff_t>(values.size() / 4);
  const double sum = std::accumulate(values.begin() + quarter, values.end() - quarter, 0.0);
  return sum / static_cast<double>(values.size() - 2 * static_cast<std::size_t>(quarter));
}

std::vector<Knot> knots_of(const std::vector<LevelPair>& pairs) {
  constexpr int width = 32;
  constexpr std::size_t fewest = 15;
  std::vector<Knot> knots;
  for (int first = 0; first < 256; first += width) {
    std::vector<double> differences;
    double sum = 0;
    for (const LevelPair& pair : pairs) {
      if (pair.from < first || pair.from >= first + width) continue;
      differences.push_back(pair.to - pair.from);
      sum += pair.from;
    }
    if (differences.size() < fewest) continue;
    const double level = sum / static_cast<double>(differences.size());
    knots.push_back({level, middle_mean(std::move(differences))});
  }
  return knots;
}

double difference_at(const std::vector<Knot>& knots, double level) {
  if (level <= knots.front().level) return knots.front().difference;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const Knot &a = knots[i - 1], &b = knots[i];
    if (level > b.level) continue;
    return std::lerp(a.difference, b.difference, (level - a.level) / (b.level - a.level));
  }
  return knots.back().difference;
}

}  // namespace

std::optional<Tones> tones_of(const std::vector<LevelPair>& pairs) {
  const std::vector<Knot> knots = knots_of(pairs);
  if (knots.empty()) return std::nullopt;
  Tones tones{};
  for (std::size_t level = 0; level < tones.curve.size(); ++level) {
    const auto at = static_cast<double>(level);
    tones.curve[level] =
        static_cast<std::uint8_t>(std::clamp(at + difference_at(knots, at) + 0.5, 0.0, 255.0));
  }
  std::vector<double> apart;
  for (const LevelPair& pair : pairs) {
    apart.push_back(std::abs(tones.curve[static_cast<std::size_t>(pair.from)] - pair.to));
  }
  constexpr double of_upper_quartile = 1.5;
  tones.tolerance =
      static_cast<int>(of_upper_quartile * quantile(std::move(apart), 0.75, QuantileKind::linear));
  return tones;
}

std::vector<LevelPair> level_pairs(const CensusCosts& costs,
                                   const SideLevels& sides,
                                   int searched) {
  constexpr int points = 600, beside = 2;
  constexpr double distinct = 0.7;
  const int step = costs.points.size() / points + 1;
  std::vector<std::int16_t> at(static_cast<std::size_t>(costs.disparities));
  std::vector<LevelPair> pairs;
  for (int p = 0; p < costs.points.size(); p += step) {
    const auto k = static_cast<std::size_t>(p);
    census_costs(costs, p, at.data());
    const int best =
        static_cast<int>(std::min_element(at.begin(), at.begin() + searched) - at.begin());
    int next = no_place_cost;
    for (int d = 0; d < searched; ++d) {
      if (std::abs(d - best) > beside) next = std::min<int>(next, at[static_cast<std::size_t>(d)]);
    }
    const int cost = at[static_cast<std::size_t>(best)];
    if (next == no_place_cost || cost >= distinct * next) continue;
    const auto [x, y] = sides.offsets[k];
    const int there = costs.first_place[k] + best;
    for (const int side : {1, -1}) {
      const int row = std::clamp(costs.points.y[k] + side * y, 0, sides.own.height - 1);
      const int across = costs.facing == Facing::same ? side * x : -side * x;
      pairs.push_back(
          {sides.other.row(row)[there + across], sides.own.row(row)[costs.points.x[k] + side * x]});
    }
  }
  return pairs;
}

LevelImage toned(LevelImage levels, const ToneCurve& curve) {
  for (std::uint8_t& level : levels.values) level = curve[level];
  return levels;
}

}  // namespace vernier::stereo::internal
