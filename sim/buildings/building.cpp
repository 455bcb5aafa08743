// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/building.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/corridors.h"
#include "sim/buildings/hall.h"
#include "sim/buildings/home.h"
#include "sim/buildings/office.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/space.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::Vector3d;

constexpr std::array<std::pair<BuildingKind, std::string_view>, 4> kind_names{{
    {BuildingKind::office, "office"},
    {BuildingKind::home, "home"},
    {BuildingKind::hall, "hall"},
    {BuildingKind::corridors, "corridors"},
}};
constexpr double beside_hall_m = 3;        ///< largest height of what is not a hall beside one
constexpr std::uint32_t part_item = 3000;  ///< of the draws from which later parts have their seeds

Vector3d usual_size_m(BuildingKind kind) {
  switch (kind) {
    case BuildingKind::office:
      return OfficeOptions{}.size_m;
    case BuildingKind::home:
      return HomeOptions{}.size_m;
    case BuildingKind::hall:
      return HallOptions{}.size_m;
    default:
      return CorridorOptions{}.size_m;
  }
}

WorldDescription make_part(BuildingKind kind,
                           std::uint64_t seed,
                           const Vector3d& size,
                           const OpenEnds& open) {
  switch (kind) {
    case BuildingKind::office: {
      OfficeOptions options;
      options.size_m = size;
      options.open = open;
      return make_office(seed, options);
    }
    case BuildingKind::home:
      return make_home(seed, {size, open});
    case BuildingKind::hall:
      return make_hall(seed, {size, open});
    default:
      return make_corridors(seed, {size, open});
  }
}

std::uint64_t seed_of_part(std::uint64_t seed, std::uint32_t part) {
  if (part == 0) return seed;
  RandomStream draws({.seed = seed, .trial = part, .feature = part_item, .source = building_draws});
  const std::uint64_t high = draws.below(1U << 31U), low = draws.below(1U << 31U);
  return (high << 31U) | low;
}

Vector3d moved(const Vector3d& x, double dx) { return to_grid(Vector3d(x + Vector3d(dx, 0, 0))); }

/// Templates of a part whose names the building has, with other features, get the part's number.
void merge_templates(WorldDescription& whole, WorldDescription& part, std::uint32_t number) {
  for (WorldTemplate& entry : part.templates) {
    const auto known =
        std::find_if(whole.templates.begin(), whole.templates.end(),
                     [&](const WorldTemplate& other) { return other.name == entry.name; });
    if (known == whole.templates.end()) {
      whole.templates.push_back(entry);
    } else if (known->features.segments_m != entry.features.segments_m) {
      const std::string name = entry.name + "_" + std::to_string(number + 1);
      for (WorldInstance& instance : part.instances) {
        if (instance.template_name == entry.name) instance.template_name = name;
      }
      whole.templates.push_back({name, entry.features});
    }
  }
}

void append(WorldDescription& whole, WorldDescription part, double dx, std::uint32_t number) {
  merge_templates(whole, part, number);
  for (WorldInstance& instance : part.instances) {
    instance.at_m = moved(instance.at_m, dx);
    whole.instances.push_back(std::move(instance));
  }
  for (const auto& [a, b] : part.loose.segments_m) {
    whole.loose.segments_m.emplace_back(moved(a, dx), moved(b, dx));
  }
  for (const Vector3d& corner : part.loose.corners_m) {
    whole.loose.corners_m.push_back(moved(corner, dx));
  }
  for (auto& polygon : part.loose.surfaces_m) {
    for (Vector3d& point : polygon) point = moved(point, dx);
    whole.loose.surfaces_m.push_back(std::move(polygon));
  }
  for (RouteLeg& leg : part.route) {
    for (auto& point : leg.points_m) point.x() = to_grid(point.x() + dx);
    whole.route.push_back(std::move(leg));
  }
}

Vector3d usual_size_m(const std::vector<BuildingKind>& kinds) {
  Vector3d size = Vector3d::Zero();
  for (const BuildingKind kind : kinds) {
    const Vector3d part = usual_size_m(kind);
    size = {size.x() + part.x(), std::max(size.y(), part.y()), std::max(size.z(), part.z())};
  }
  return size + Vector3d((static_cast<double>(kinds.size()) - 1) * wall_thickness_m, 0, 0);
}

}  // namespace

std::string_view name_of(BuildingKind kind) {
  return std::find_if(kind_names.begin(), kind_names.end(),
                      [&](const auto& entry) { return entry.first == kind; })
      ->second;
}

std::optional<BuildingKind> building_kind(std::string_view name) {
  const auto entry = std::find_if(kind_names.begin(), kind_names.end(),
                                  [&](const auto& known) { return known.second == name; });
  if (entry == kind_names.end()) return std::nullopt;
  return entry->first;
}

WorldDescription make_building(std::uint64_t seed, const BuildingOptions& options) {
  const std::vector<BuildingKind>& kinds = options.kinds;
  if (kinds.empty()) throw Error("building", "no kind is given", "give at least one");
  const Vector3d size = options.size_m.value_or(usual_size_m(kinds));
  const auto parts = static_cast<std::uint32_t>(kinds.size());
  if (parts == 1) return make_part(kinds[0], seed, size, {});

  Vector3d part_size = size;
  part_size.x() = to_grid((size.x() - (parts - 1) * wall_thickness_m) / parts);
  const bool holds_hall = std::find(kinds.begin(), kinds.end(), BuildingKind::hall) != kinds.end();
  WorldDescription whole;
  whole.name = "building-" + std::to_string(seed);
  for (std::uint32_t i = 0; i < parts; ++i) {
    const double dx = i * (part_size.x() + wall_thickness_m);
    Vector3d own_size = part_size;
    if (holds_hall && kinds[i] != BuildingKind::hall) {
      own_size.z() = std::min(own_size.z(), beside_hall_m);
    }
    append(whole, make_part(kinds[i], seed_of_part(seed, i), own_size, {i > 0, i + 1 < parts}), dx,
           i);
  }
  return whole;
}

}  // namespace vernier::sim::internal
