// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/even_storeys.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

constexpr double level_cosine = 0.98;
constexpr double least_share = 0.33;  // of the plan's bounding box: a floor, also of an L
constexpr double even = 0.02;         // of a storey
constexpr double most_slender = 3;    // height by the narrower side of the plan
constexpr std::size_t most_levels = 200;

/// Level area by height, in slices.
class LevelArea {
 public:
  LevelArea(const Mesh& mesh, int axis) {
    const auto [low, high] = extent_of(mesh);
    low_ = low[axis];
    slice_ = std::max(high[axis] - low[axis], 1e-300) / slices;
    std::array<double, slices + 1> area{};
    for (const auto& [a, b, c] : mesh.triangles) {
      const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
      const Eigen::Vector3d twice = (q - p).cross(r - p);
      if (!(std::abs(twice[axis]) > level_cosine * twice.norm())) continue;
      area[slice_at((p[axis] + q[axis] + r[axis]) / 3)] += 0.5 * std::abs(twice[axis]);
    }
    for (std::size_t i = 0; i < area.size(); ++i) sum_[i + 1] = sum_[i] + area[i];
  }

  /// Within a distance of a height.
  double near(double height, double within) const {
    if (height + within < low_ || height - within > low_ + slices * slice_) return 0;
    return sum_[slice_at(height + within) + 1] - sum_[slice_at(height - within)];
  }

  /// Heights at which there is at least so much, one for each run of slices.
  std::vector<double> levels(double least) const {
    std::vector<double> found;
    for (std::size_t i = 0; i <= slices; ++i) {
      double area = 0, moment = 0;
      for (; i <= slices && sum_[i + 1] > sum_[i]; ++i) {
        const double here = sum_[i + 1] - sum_[i];
        area += here;
        moment += here * static_cast<double>(i);
      }
      if (area >= least) found.push_back(low_ + slice_ * moment / area);
    }
    return found;
  }

  double slice() const { return slice_; }

 private:
  static constexpr std::size_t slices = 2000;
  std::size_t slice_at(double height) const {
    const double at = std::round((height - low_) / slice_);
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(slices)));
  }
  double low_ = 0, slice_ = 1;
  std::array<double, slices + 2> sum_{};
};

}  // namespace

std::optional<EvenStoreys> even_storeys(const Mesh& mesh, int axis) {
  if (mesh.triangles.empty()) return {};
  const auto [low, high] = extent_of(mesh);
  const Eigen::Vector3d size = high - low;
  const double one = size[(axis + 1) % 3], other = size[(axis + 2) % 3];
  if (!(size[axis] > 0) || size[axis] > most_slender * std::min(one, other)) return {};
  const LevelArea area(mesh, axis);
  const double least = least_share * one * other;
  const std::vector<double> levels = area.levels(least);
  if (levels.size() > most_levels) return {};
  std::optional<EvenStoreys> best;
  double most = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (std::size_t k = i + 1; k < levels.size(); ++k) {
      const double storey = levels[k] - levels[i], within = std::max(area.slice(), even * storey);
      if (area.near(levels[i] - storey, within) >= least) continue;  // begins lower
      int floors = 1;
      double all = area.near(levels[i], within);
      for (; area.near(levels[i] + floors * storey, within) >= least; ++floors) {
        all += area.near(levels[i] + floors * storey, within);
      }
      // Below the first may lie a cellar or a higher ground floor, and above the last a storey and
      // a roof. Two levels alone make a row anywhere: the upper storey must be as high.
      const double below = levels[i] - low[axis];
      const double above = high[axis] - (levels[i] + (floors - 1) * storey);
      const bool is_row =
          floors > 2 ? below < 2 * storey && above < 2 * storey
                     : below < 0.4 * storey && above > 0.85 * storey && above < 1.4 * storey;
      const int count = floors - (above < 0.6 * storey ? 1 : 0);
      if (!is_row || count < 2 || all <= most) continue;
      most = all;
      best = EvenStoreys{levels[i], storey, count};
    }
  }
  return best;
}

}  // namespace vernier::sim::internal
