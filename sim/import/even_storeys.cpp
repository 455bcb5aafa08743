// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/even_storeys.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sim/import/levels.h"
#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

constexpr double even = 0.02;       // of a storey
constexpr double most_slender = 3;  // height by the narrower side of the plan
constexpr double most_slender_of_many = 4.5;
constexpr double most_slender_of_a_tower = 8;
constexpr int many = 5, tower = 6;  // storeys
constexpr double half_way = 0.15;   // of a storey, from its middle
constexpr std::size_t most_levels = 200;

// What lies below and above a row of levels, in storeys.
constexpr double most_below = 2;         // a cellar, or a ground floor that is higher
constexpr double most_above = 2;         // the last storey and a flat roof
constexpr double most_roof = 3.5;        // the last storey and a steep roof, above four levels
constexpr double most_plinth = 0.4;      // below two levels
constexpr double least_upper = 0.85;     // above two levels: a storey like the lower
constexpr double most_upper = 1.4;       // with a parapet
constexpr double least_of_storey = 0.6;  // else the last level is the roof

/// The level nearest to a height, if it lies within a distance.
const Level* level_near(const std::vector<Level>& levels, double height, double within) {
  const Level* nearest = nullptr;
  for (const Level& level : levels) {
    if (std::abs(level.height - height) > within) continue;
    if (nearest == nullptr ||
        std::abs(level.height - height) < std::abs(nearest->height - height)) {
      nearest = &level;
    }
  }
  return nearest;
}

/// Levels at even heights, from the lowest of them on.
struct StoreyRow {
  double first, storey, last;
  int floors;
  double area;
};

/// The row that begins with two levels; its storey is the mean of those found so far.
StoreyRow row_from(const std::vector<Level>& levels, const Level& first, const Level& second) {
  StoreyRow row{first.height, second.height - first.height, second.height, 2,
                first.area + second.area};
  for (;;) {
    const Level* next = level_near(levels, row.last + row.storey, even * row.storey);
    if (next == nullptr) return row;
    row.area += next->area;
    row.last = next->height;
    row.storey = (row.last - row.first) / row.floors;
    ++row.floors;
  }
}

/// Whether another level lies half way between two of a row: then each is of two storeys.
bool skips_levels(const std::vector<Level>& levels, const StoreyRow& row) {
  return std::any_of(levels.begin(), levels.end(), [&](const Level& level) {
    const double storeys = (level.height - row.first) / row.storey;
    return level.height > row.first && level.height < row.last &&
           std::abs(storeys - std::floor(storeys) - 0.5) < half_way;
  });
}

}  // namespace

std::optional<EvenStoreys> even_storeys(const Mesh& mesh, int axis) {
  if (mesh.triangles.empty()) return {};
  const auto [low, high] = extent_of(mesh);
  const Eigen::Vector3d size = high - low;
  const double one = size[(axis + 1) % 3], other = size[(axis + 2) % 3];
  if (!(size[axis] > 0)) return {};
  const double slender = size[axis] / std::min(one, other);
  const std::vector<Level> levels = levels_of(mesh, axis, least_of_plan * one * other);
  if (levels.size() > most_levels) return {};
  std::optional<EvenStoreys> best;
  double most = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (std::size_t k = i + 1; k < levels.size(); ++k) {
      const double storey = levels[k].height - levels[i].height;
      if (level_near(levels, levels[i].height - storey, even * storey) != nullptr) continue;
      const StoreyRow row = row_from(levels, levels[i], levels[k]);
      // Below the first may lie a cellar or a higher ground floor, and above the last a storey and
      // a roof, which is higher where the house is wide. Two levels alone make a row anywhere: the
      // upper storey must be as high.
      const double below = (row.first - low[axis]) / row.storey;
      const double above = (high[axis] - row.last) / row.storey;
      const bool is_row =
          row.floors > 2 ? below < most_below && above < (row.floors > 3 ? most_roof : most_above)
                         : below < most_plinth && above > least_upper && above < most_upper;
      const int count = row.floors - (above < least_of_storey ? 1 : 0);
      const bool is_slender = slender > (count < many    ? most_slender
                                         : count < tower ? most_slender_of_many
                                                         : most_slender_of_a_tower);
      if (!is_row || count < 2 || is_slender || row.area <= most || skips_levels(levels, row)) {
        continue;
      }
      most = row.area;
      best = EvenStoreys{row.first, row.storey, count};
    }
  }
  return best;
}

}  // namespace vernier::sim::internal
