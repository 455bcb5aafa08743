// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calib/error.h"
#include "localise/place.h"

namespace vernier::sim {

using namespace localise;

namespace {

double heading_of(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

}  // namespace

double route_length_m(const std::vector<RouteLeg>& route) {
  double length = 0;
  for (const RouteLeg& leg : route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      length += (leg.points_m[i] - leg.points_m[i - 1]).norm();
    }
  }
  return length;
}

RoutePoint route_point(const std::vector<RouteLeg>& route, double s_m) {
  RoutePoint point;
  double left = std::max(0.0, s_m);
  for (std::size_t l = 0; l < route.size(); ++l) {
    double along_leg = 0;
    for (std::size_t i = 1; i < route[l].points_m.size(); ++i) {
      const Eigen::Vector2d &a = route[l].points_m[i - 1], &b = route[l].points_m[i];
      const double length = (b - a).norm();
      const double step = std::min(left, length);
      const Eigen::Vector2d at = a + (b - a) * (length > 0 ? step / length : 0);
      point = {{at.x(), at.y(), heading_of(a, b)}, along_leg + step, static_cast<int>(l)};
      if (left < length) return point;
      left -= length;
      along_leg += length;
    }
  }
  return point;
}

std::vector<Pose2D> map_poses(const std::vector<RouteLeg>& route, double spacing_m, int headings) {
  if (route.empty()) {
    throw Error("map", "the world has no route to record the map along",
                "add [[route]] points_m to the world");
  }
  if (!(spacing_m > 0) || headings < 0) {
    throw Error("map", "spacing is not above 0 or headings is negative", "use positive values");
  }
  std::vector<Pose2D> places;
  for (const RouteLeg& leg : route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      const Eigen::Vector2d &a = leg.points_m[i - 1], &b = leg.points_m[i];
      const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / spacing_m - 1e-9)));
      for (int k = 0; k < steps; ++k) {
        const Eigen::Vector2d at = a + (b - a) * k / steps;
        if (headings == 0) places.push_back({at.x(), at.y(), heading_of(a, b)});
        for (int h = 0; h < headings; ++h) {
          places.push_back({at.x(), at.y(), 2 * std::numbers::pi * h / headings});
        }
      }
    }
  }
  return places;
}

}  // namespace vernier::sim
