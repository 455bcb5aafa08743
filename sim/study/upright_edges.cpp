// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/upright_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "sim/world.h"

namespace vernier::sim::internal {

bool is_upright(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  constexpr double slope = 1e-6;
  return (a_m - b_m).head<2>().norm() < slope * std::abs(a_m.z() - b_m.z());
}

UprightEdges::UprightEdges(const World& world) {
  constexpr double step_m = 1e-3;
  std::map<std::pair<double, double>, std::size_t> class_of;
  for (const WorldSegment& segment : world.segments) {
    if (!is_upright(segment.a_m, segment.b_m)) continue;
    const auto [low, high] = std::minmax(segment.a_m.z(), segment.b_m.z());
    const std::pair<double, double> rounded{std::round(low / step_m), std::round(high / step_m)};
    const auto [found, added] = class_of.emplace(rounded, classes_.size());
    if (added) classes_.push_back({low, high, {}});
    HeightClass& all = classes_[found->second];
    all.low_m = std::min(all.low_m, low);
    all.high_m = std::max(all.high_m, high);
    const auto number = static_cast<int>(all.uprights.size());
    all.uprights.push_back({segment.a_m.head<2>(), low, high});
    all.close.add(all.uprights.back().at_m, number);
    all.wide.add(all.uprights.back().at_m, number);
  }
}

int UprightEdges::count_around(const Upright& part) const {
  std::size_t count = 0;
  for (const HeightClass& all : classes_) {
    if (all.may_hold(part)) count += all.uprights.size();
  }
  return static_cast<int>(count);
}

bool UprightEdges::has(const Upright& part) const {
  return std::any_of(classes_.begin(), classes_.end(), [&](const HeightClass& all) {
    return all.may_hold(part) && all.close.any_near(part.at_m, tolerance_m, [&](int i) {
      return (all.uprights[i].at_m - part.at_m).squaredNorm() < tolerance_m * tolerance_m;
    });
  });
}

}  // namespace vernier::sim::internal
