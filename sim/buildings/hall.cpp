// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/hall.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/hall_furniture.h"
#include "sim/buildings/office_clutter.h"
#include "sim/buildings/space.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::AlignedBox2d;
using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double perimeter_m = 2.0;  ///< of the route's way around, from the walls
constexpr double margin_m = 4.0;     ///< of the rows, from the walls
constexpr double aisle_m = 3.0;      ///< between rows
constexpr double row_m = 2.4;        ///< of two bays, back to back
constexpr double cross_aisle_m = 3.0;
constexpr double frame_pitch_m = 6.7;  ///< of columns and beams: two bays fit between

// Keys of draws, with steps for rows and walls.
enum HallItem : std::uint32_t {
  hall_layout_item = 0,
  hall_wall_item = 40,
  hall_row_item = 1000,
};

struct HallPlan {
  Vector3d size;
  std::vector<double> rows_m;                          ///< y of their middles
  std::vector<std::pair<double, double>> stretches_m;  ///< x from and to, the same for all rows
  std::vector<RouteLeg> route;
};

void check_hall(const Vector3d& size) {
  const auto refuse = [](const std::string& fault, const std::string& remedy) {
    throw Error("hall", fault, remedy);
  };
  if (!size.allFinite()) refuse("a size is not finite", "use finite lengths in metres");
  if (size.maxCoeff() > 500) refuse("a length is above 500 m", "use at most 500 m");
  if (size.z() < 4.5) refuse("the height is below 4.5 m", "use at least 4.5 m, for the racks");
  if (size.head<2>().minCoeff() < 8) {
    refuse("neither racks nor a way around them fit", "use at least 8 m each way");
  }
}

HallPlan plan_hall(std::uint64_t seed, const HallOptions& options) {
  HallPlan plan;
  plan.size = to_grid(options.size_m);
  const double length = plan.size.x(), width = plan.size.y(), middle = to_grid(width / 2);
  RandomStream draws(
      {.seed = seed, .trial = 0, .feature = hall_layout_item, .source = building_draws});
  const double for_rows = width - 2 * margin_m;
  const int rows =
      for_rows < row_m ? 0 : 1 + static_cast<int>((for_rows - row_m) / (row_m + aisle_m));
  const double pitch = rows > 1 ? (for_rows - row_m) / (rows - 1) : 0;
  for (int i = 0; i < rows; ++i) {
    plan.rows_m.push_back(to_grid(rows > 1 ? margin_m + row_m / 2 + pitch * i : width / 2));
  }
  // The rows are interrupted where cross aisles go through.
  double from = margin_m;
  const double end = length - margin_m;
  std::vector<double> crossings;
  while (end - from > 12) {
    const double to = to_grid(from + draws.uniform(6, std::min(18.0, end - from - cross_aisle_m)));
    plan.stretches_m.emplace_back(from, to);
    crossings.push_back(to_grid(to + cross_aisle_m / 2));
    from = to + cross_aisle_m;
  }
  if (end - from > bay_width_m) plan.stretches_m.emplace_back(from, end);

  const double x0 = perimeter_m, x1 = length - perimeter_m;
  const double y0 = perimeter_m, y1 = width - perimeter_m;
  const auto leg = [&](std::vector<Vector2d> points) {
    for (Vector2d& point : points) point = {to_grid(point.x()), to_grid(point.y())};
    plan.route.push_back({std::move(points)});
  };
  leg({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}});
  for (int i = 0; i + 1 < rows; ++i) {
    const double y = (plan.rows_m[i] + plan.rows_m[i + 1]) / 2;
    leg({{x0, y}, {x1, y}});
  }
  for (const double x : crossings) leg({{x, y0}, {x, y1}});
  if (options.open.low_x) leg({{0, middle}, {x0, middle}});
  if (options.open.high_x) leg({{x1, middle}, {length, middle}});
  return plan;
}

void raise_structure(BuildingSite& site, const HallPlan& plan) {
  const Vector3d& size = plan.size;
  const int frames = std::max(2, static_cast<int>(std::round(size.x() / frame_pitch_m)));
  for (int i = 0; i < frames; ++i) {
    const double x = (i + 0.5) * size.x() / frames;
    site.place("roof_beam", {{x, 0, size.z()}, 0}, Vector3d::Zero());
    std::vector<double> places{0.3, size.y() - 0.3};
    if (size.y() > 16) places.insert(places.end(), plan.rows_m.begin(), plan.rows_m.end());
    for (const double y : places) {
      const QuarterFrame frame{{x, y, 0}, 0};
      const AlignedBox3d box(Vector3d(-0.26, -0.2, 0), Vector3d(0.26, 0.2, size.z()));
      if (!site.is_free(frame * box)) continue;
      site.occupy(frame * box);
      site.place("column", frame, Vector3d::Zero());
    }
    for (double y = 3; y < size.y(); y += 6) {
      const double at = x + 0.5 * size.x() / frames;
      if (at + 1 < size.x()) site.place("strip_light", {{at, y, size.z()}, 0}, Vector3d::Zero());
    }
  }
  site.loose().frame = {};
  for (double y = 2; y + 1 < size.y(); y += 2) {
    site.loose().line({0, y, size.z() - 0.01}, {size.x(), y, size.z() - 0.01});
  }
}

void load_bay(BuildingSite& site, const QuarterFrame& frame, double x, RandomStream& draws) {
  for (const double level : bay_levels_m) {
    for (const double place : {0.13, 1.45}) {
      const double kind = draws.uniform(), shift = draws.uniform(0, 0.04);
      if (kind < 0.25) continue;
      const auto load = 1 + static_cast<int>((kind - 0.25) / 0.75 * 4);
      site.place("pallet_load_" + std::to_string(std::min(load, 4)), frame,
                 {x + place + shift, 0.08, level});
    }
  }
}

/// What fills a stretch of a row.
enum class RowUse { racks, machines, pallets };

std::string name_of_load(RowUse use, RandomStream& draws) {
  switch (use) {
    case RowUse::racks:
      return "rack_bay";
    case RowUse::machines:
      return "machine_" + std::to_string(1 + draws.below(3));
    default:
      return "pallet_load_" + std::to_string(1 + draws.below(4));
  }
}

void fill_row(BuildingSite& site, const HallPlan& plan, std::size_t row, std::size_t stretch) {
  RandomStream draws =
      site.draws(hall_row_item + static_cast<std::uint32_t>(row * 64 + stretch % 64));
  const double kind = draws.uniform();
  const RowUse use = kind < 0.55 ? RowUse::racks : kind < 0.8 ? RowUse::machines : RowUse::pallets;
  const auto [from, to] = plan.stretches_m[stretch];
  for (const int quarters : {0, 2}) {
    // The backs of the two halves meet in the middle of the row.
    const QuarterFrame frame{{quarters == 0 ? from : to, plan.rows_m[row], 0}, quarters};
    const double length = to - from;
    double x = 0.02;
    while (x < length) {
      const std::string name = name_of_load(use, draws);
      const double width =
          use == RowUse::racks ? bay_width_m : site.taken(name, {}, Vector3d::Zero()).max().x();
      if (x + width > length) break;
      if (!site.try_place(name, frame, {x, 0, 0})) {
        x += 0.25;  // a column stands there
        continue;
      }
      if (use == RowUse::racks) load_bay(site, frame, x, draws);
      x += width + (use == RowUse::racks      ? 0.02
                    : use == RowUse::machines ? draws.uniform(0.5, 1.8)
                                              : draws.uniform(0.05, 1.2));
    }
  }
}

void furnish_hall_wall(BuildingSite& site, const RoomWall& wall, std::uint32_t number) {
  RandomStream draws = site.draws(hall_wall_item + number);
  const double length = wall.length_m, height = site.room().high_m.z();
  const auto anywhere = [&](double width) {
    return draws.uniform(0.2, std::max(0.3, length - width));
  };
  const int gates = number % 2 == 0 ? static_cast<int>(length / 12) : static_cast<int>(length / 25);
  for (int i = 0; i < gates; ++i) site.try_place("gate", wall.frame, {anywhere(4) + 0.3, 0, 0});
  if (height > 5.5) {
    for (double x = draws.uniform(0.5, 2); x + 3 < length; x += 4) {
      site.place("high_window", wall.frame, {x, 0, height - 1.5});
    }
  }
  for (int i = 0; i < static_cast<int>(length / 2); ++i) {
    const double kind = draws.uniform();
    if (kind < 0.3) {
      const double x = anywhere(2.2);
      if (site.try_place("workbench", wall.frame, {x, 0, 0})) {
        litter_top(site, wall.frame, {x + 0.05, 0.1, 0.88}, {1.9, 0.55}, 3, draws);
      }
    } else if (kind < 0.45) {
      site.try_place("electrical_cabinet", wall.frame, {anywhere(1), 0, 0});
    } else if (kind < 0.6) {
      const double x = anywhere(2);
      for (int k = 0; k < 4; ++k) site.try_place("locker", wall.frame, {x + 0.42 * k, 0, 0});
    } else if (kind < 0.75) {
      const double x = anywhere(1.4);
      if (site.try_place("notice_board", wall.frame, {x, 0, 0})) {
        pin_papers(site, wall.frame, {x + 0.03, 1.18}, {x + 1.17, 1.97}, draws);
      }
    } else if (kind < 0.9) {
      const double x = anywhere(1.3);
      site.try_place("pallet_load_" + std::to_string(1 + draws.below(4)), wall.frame, {x, 0, 0});
    } else {
      const double x = anywhere(0.9), y = 1.0;
      const AlignedBox3d box(Vector3d(x, y - 0.35, 0), Vector3d(x + 0.95, y + 0.35, 1));
      if (site.is_free(wall.frame * box)) {
        site.occupy(wall.frame * box);
        site.place("trolley", wall.frame, {x + 0.47, y, 0}, static_cast<int>(draws.below(360)));
      }
    }
  }
  drop_cartons(site, wall, static_cast<int>(length / 6), draws);
  hang_pictures(site, wall, static_cast<int>(length / 5), draws);
}

}  // namespace

WorldDescription make_hall(std::uint64_t seed, const HallOptions& options) {
  check_hall(options.size_m);
  HallPlan plan = plan_hall(seed, options);
  const Vector3d& size = plan.size;
  BuildingSite site(seed);
  for (const WorldTemplate& entry : hall_templates(seed, size.y(), size.z())) site.define(entry);

  const std::vector<AlignedBox2d> floor{{Vector2d::Zero(), Vector2d(size.head<2>())}};
  const std::vector<RoomWall> walls = walls_around(floor);
  const std::vector<Opening> openings = end_openings(walls, size, options.open);
  raise_room(site.loose(), floor, walls, size.z(), openings);
  std::vector<FloorPath> paths;
  for (const RouteLeg& leg : plan.route) paths.push_back(leg.points_m);
  site.enter(1, {AlignedBox3d(Vector3d::Zero(), size)}, paths);
  fit_end_doorways(site, walls, openings, 0.15, 1);
  raise_structure(site, plan);
  for (std::size_t row = 0; row < plan.rows_m.size(); ++row) {
    for (std::size_t i = 0; i < plan.stretches_m.size(); ++i) fill_row(site, plan, row, i);
  }
  for (std::uint32_t i = 0; i < walls.size(); ++i) furnish_hall_wall(site, walls[i], i);
  WorldDescription world = site.finish();
  world.name = "hall-" + std::to_string(seed);
  world.route = std::move(plan.route);
  return world;
}

}  // namespace vernier::sim::internal
