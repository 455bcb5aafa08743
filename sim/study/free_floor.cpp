// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/free_floor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/study/blocked_route.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace vernier::internal;

namespace {

constexpr double step_m = 0.15;
constexpr std::size_t most_nodes = 1'000'000;

BoxTree tree_of_surfaces(const World& world) {
  std::vector<Eigen::AlignedBox3d> boxes(world.surfaces.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (const Eigen::Vector3d& point : world.surfaces[i].polygon_m) boxes[i].extend(point);
  }
  return BoxTree(std::move(boxes));
}

}  // namespace

Standing::Standing(const World& world, double eye_height_m)
    : world_(world), top_m_(eye_height_m + robot_top_m), surfaces_(tree_of_surfaces(world)) {
  const WorldExtent box = standing_box(world);
  low_m = box.low_m.head<2>();
  high_m = box.high_m.head<2>();
}

bool Standing::is_free(const Eigen::Vector2d& at_m) const {
  constexpr double deep_m = -1e9;
  const Eigen::Vector2d about = Eigen::Vector2d::Constant(robot_radius_m);
  Eigen::AlignedBox3d around;
  around.min() << at_m - about, deep_m;
  around.max() << at_m + about, top_m_;
  bool free = true;
  surfaces_.visit([&](const Eigen::AlignedBox3d& box) { return around.intersects(box); },
                  [&](int i) {
                    free = !blocks(world_.surfaces[i], at_m, robot_radius_m, top_m_);
                    return !free;
                  });
  return free;
}

FreeFloor::FreeFloor(const Visibility& visibility, double eye_height_m)
    : visibility_(visibility),
      height_m_(eye_height_m),
      standing_(visibility.world(), eye_height_m) {
  spread();
}

Eigen::Vector2d FreeFloor::at(const Node& node) const {
  return standing_.low_m + step_m * Eigen::Vector2d(node.first, node.second);
}

FreeFloor::Node FreeFloor::nearest(const Eigen::Vector2d& at_m) const {
  const Eigen::Vector2d steps = (at_m - standing_.low_m) / step_m;
  return {static_cast<int>(std::lround(steps.x())), static_cast<int>(std::lround(steps.y()))};
}

bool FreeFloor::sees(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const {
  return visibility_.sees({from_m.x(), from_m.y(), height_m_}, {to_m.x(), to_m.y(), height_m_});
}

void FreeFloor::spread() {
  std::vector<Node> open;
  const auto reach = [&](const Node& node, const Eigen::Vector2d& from) {
    const Eigen::Vector2d to = at(node);
    if (!standing_.in_box(to) || reached_.count(key(node)) > 0) return;
    if (!standing_.is_free(to) || !sees(from, to)) return;
    reached_.insert(key(node));
    open.push_back(node);
  };
  const auto& route = visibility_.world().route;
  for (double s = 0, length = route_length_m(route); s < length; s += step_m) {
    const Pose2D pose = route_point(route, s).pose;
    const Eigen::Vector2d from(pose.x_m, pose.y_m);
    const auto [x, y] = nearest(from);
    for (const int dx : {-1, 0, 1}) {
      for (const int dy : {-1, 0, 1}) reach({x + dx, y + dy}, from);
    }
  }
  std::set<Node> cells;
  while (!open.empty()) {
    const Node node = open.back();
    open.pop_back();
    const auto [x, y] = node;
    for (const int dx : {-1, 0, 1}) {
      for (const int dy : {-1, 0, 1}) cells.insert({x + dx, y + dy});
    }
    for (const Node& next : {Node{x + 1, y}, Node{x - 1, y}, Node{x, y + 1}, Node{x, y - 1}}) {
      reach(next, at(node));
    }
    if (reached_.size() > most_nodes) {
      bounded_ = false;
      reached_.clear();
      return;
    }
  }
  cells_.assign(cells.begin(), cells.end());
}

bool FreeFloor::reaches(const Eigen::Vector2d& at_m) const {
  if (!standing_.in_box(at_m) || !standing_.is_free(at_m)) return false;
  if (!bounded_) return true;
  const auto [x, y] = nearest(at_m);
  for (const int dx : {0, -1, 1}) {
    for (const int dy : {0, -1, 1}) {
      const Node node{x + dx, y + dy};
      if (reached_.count(key(node)) > 0 && sees(at(node), at_m)) return true;
    }
  }
  return false;
}

Eigen::Vector2d FreeFloor::draw(RandomStream& draws) const {
  if (!bounded_) {
    throw Error("queries", "the floor around the route has no end, or more than 22,500 m2",
                "close the world with walls, or use the protocol anywhere");
  }
  for (int attempt = 0; attempt < 1000 && !cells_.empty(); ++attempt) {
    const auto count = static_cast<double>(cells_.size());
    const auto chosen = static_cast<std::size_t>(draws.uniform(0, count));
    const Node& cell = cells_[std::min(chosen, cells_.size() - 1)];
    const double x = draws.uniform(-step_m / 2, step_m / 2);
    const double y = draws.uniform(-step_m / 2, step_m / 2);
    const Eigen::Vector2d place = at(cell) + Eigen::Vector2d(x, y);
    if (reaches(place)) return place;
  }
  throw_no_free_position(visibility_.world(), height_m_);
}

}  // namespace vernier::sim::internal
