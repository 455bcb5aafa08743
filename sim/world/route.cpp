// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calib/error.h"
#include "localise/place.h"
#include "sim/world.h"
#include "sim/world/world_limits.h"

namespace vernier::sim {

using namespace localise;
using namespace internal;

namespace {

double heading_of(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

/// Of one piece of a leg. As a double, since it can be larger than any integer.
double step_count(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double spacing_m) {
  const double steps = std::ceil((to - from).norm() / spacing_m - 1e-9);
  return steps < 1 ? 1 : steps;  // not a number remains it
}

double view_count(const std::vector<RouteLeg>& route, double spacing_m, int headings) {
  double steps = 0;
  for (const RouteLeg& leg : route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      steps += step_count(leg.points_m[i - 1], leg.points_m[i], spacing_m);
    }
  }
  return steps * std::max(1, headings);
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
  const double views = view_count(route, spacing_m, headings);
  if (!(views <= static_cast<double>(most_map_views))) {
    throw Error("map",
                fmt::format("its route of {:g} m gives {:g} views at a spacing of {:g} m, more "
                            "than {}",
                            route_length_m(route), views, spacing_m, most_map_views),
                "use a larger spacing, fewer headings or a shorter route");
  }
  std::vector<Pose2D> places;
  places.reserve(static_cast<std::size_t>(views));
  for (const RouteLeg& leg : route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      const Eigen::Vector2d &a = leg.points_m[i - 1], &b = leg.points_m[i];
      const int steps = static_cast<int>(step_count(a, b, spacing_m));
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

std::vector<Pose2D> drive_poses(const RouteLeg& leg, double step_m, double turn_rad) {
  if (!(step_m > 0) || !(turn_rad > 0)) {
    throw Error("drive", "a step is not above 0", "use positive values");
  }
  std::vector<Pose2D> poses;
  const auto add = [&](const Pose2D& pose) {
    if (poses.size() == most_map_views) {
      throw Error("drive", fmt::format("has more than {} poses", most_map_views),
                  "use larger steps");
    }
    poses.push_back(pose);
  };
  for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
    const Eigen::Vector2d &a = leg.points_m[i - 1], &b = leg.points_m[i];
    if (a == b) continue;
    const Pose2D start{a.x(), a.y(), heading_of(a, b)};
    if (poses.empty()) {
      add(start);
    } else {
      const double turn = localise::heading_difference_rad(start, poses.back());
      const double before = poses.back().heading_rad;
      const double turns = std::ceil(std::abs(turn) / turn_rad);
      for (double k = 1; k <= turns; ++k) {
        add({start.x_m, start.y_m, before + turn * k / turns});
      }
    }
    const double steps = std::ceil((b - a).norm() / step_m);
    for (double k = 1; k <= steps; ++k) {
      const Eigen::Vector2d at = a + (b - a) * (k / steps);
      add({at.x(), at.y(), poses.back().heading_rad});
    }
  }
  return poses;
}

}  // namespace vernier::sim
