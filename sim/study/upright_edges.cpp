// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/upright_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "sim/study/floor_rows.h"
#include "sim/world.h"

namespace vernier::sim::internal {

bool is_upright(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  constexpr double slope = 1e-6;
  return (a_m - b_m).head<2>().norm() < slope * std::abs(a_m.z() - b_m.z());
}

UprightEdges::UprightEdges(const World& world) {
  constexpr double step_m = 1e-3;
  std::map<std::pair<double, double>, std::vector<Upright>> classes;
  Eigen::AlignedBox2d extent;
  for (const WorldSegment& segment : world.segments) {
    if (!is_upright(segment.a_m, segment.b_m)) continue;
    const auto [low, high] = std::minmax(segment.a_m.z(), segment.b_m.z());
    classes[{std::round(low / step_m), std::round(high / step_m)}].push_back(
        {segment.a_m.head<2>(), low, high});
    extent.extend(segment.a_m.head<2>());
  }
  for (const auto& [heights, all] : classes) {
    HeightClass c{all[0].low_m, all[0].high_m, static_cast<int>(uprights_.size()), 0};
    for (const Upright& upright : all) {
      c.low_m = std::min(c.low_m, upright.low_m);
      c.high_m = std::max(c.high_m, upright.high_m);
      uprights_.push_back(upright);
    }
    c.last = static_cast<int>(uprights_.size());
    classes_.push_back(c);
  }
  std::vector<Eigen::Vector2d> places_m;
  for (const Upright& upright : uprights_) {
    close_.add(upright.at_m, static_cast<int>(places_m.size()));
    places_m.push_back(upright.at_m);
  }
  if (!places_m.empty()) {  // rows as high as a square of about four edges
    const double area_m2 = (extent.sizes().array() + 1).prod();
    row_m_ = std::clamp(std::sqrt(4 * area_m2 / static_cast<double>(places_m.size())), 0.05, 1.0);
  }
  rows_ = FloorRows(places_m, row_m_);
}

UprightEdges::Matches UprightEdges::matches(const Upright& part) const {
  Matches found;
  for (const HeightClass& all : classes_) {
    if (!may_hold(all, part)) continue;
    found.count += all.last - all.first;
    if (!found.ranges.empty() && found.ranges.back().last == all.first) {
      found.ranges.back().last = all.last;
    } else {
      found.ranges.push_back({all.first, all.last});
    }
  }
  return found;
}

int UprightEdges::count_around(const Upright& part) const {
  int count = 0;
  for (const HeightClass& all : classes_) {
    if (may_hold(all, part)) count += all.last - all.first;
  }
  return count;
}

bool UprightEdges::has(const Upright& part) const {
  return close_.any_near(part.at_m, tolerance_m, [&](int i) {
    return may_hold(uprights_[i], part) &&
           (uprights_[i].at_m - part.at_m).squaredNorm() < tolerance_m * tolerance_m;
  });
}

}  // namespace vernier::sim::internal
