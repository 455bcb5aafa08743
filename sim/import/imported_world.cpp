// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/imported_world.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/base/all_within.h"
#include "calib/error.h"
#include "sim/import/axes_and_unit.h"
#include "sim/import/convex_faces.h"
#include "sim/import/crease_edges.h"
#include "sim/import/levelled.h"
#include "sim/import/mesh.h"
#include "sim/import/point_grid.h"
#include "sim/import/storeys.h"
#include "sim/world.h"
#include "sim/world/world_check.h"
#include "sim/world/world_limits.h"

namespace vernier::sim::internal {

namespace {

constexpr double weld_m = 5e-4;
constexpr double largest_in_file = 1e9;  // in its units; of maps in millimetres too
constexpr double infinity = std::numeric_limits<double>::infinity();

void check(const Mesh& mesh, const std::string& place) {
  if (mesh.triangles.empty() && mesh.lines.empty()) {
    throw Error(place, "holds no triangles and no lines", "export the geometry of a building");
  }
  if (mesh.triangles.size() > most_triangles || mesh.lines.size() > most_triangles) {
    throw Error(place,
                fmt::format("has {} triangles and {} lines, more than {}", mesh.triangles.size(),
                            mesh.lines.size(), most_triangles),
                "export a storey, or fewer details");
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d& v = mesh.vertices[i];
    if (vernier::internal::all_within(v, largest_in_file)) continue;
    throw Error(place,
                fmt::format("vertex {} is {}", i,
                            v.allFinite() ? "further than 1e9 units away" : "not finite"),
                "correct it, or export again");
  }
}

/// Where the storey begins and ends.
std::pair<double, double> heights_of(const ImportOptions& options,
                                     const Mesh& mesh,
                                     const std::vector<Polygon>& faces,
                                     double lift,
                                     const std::string& place,
                                     ImportReport& report) {
  report.storeys_m = floor_heights_m(faces);
  double floor = infinity, top = infinity;
  if (options.floor_m) {
    floor = *options.floor_m - lift;
  } else if (report.storeys_m.empty()) {
    if (options.storey != 1) throw Error(place, "no storeys were found", "give the floor's height");
    floor = extent_of(mesh).low.z();
  } else {
    const auto count = static_cast<int>(report.storeys_m.size());
    if (options.storey < 1 || options.storey > count) {
      throw Error(place, fmt::format("has {} storeys, and no storey {}", count, options.storey),
                  "give one of them, or the floor's height");
    }
    floor = report.storeys_m[options.storey - 1];
  }
  constexpr double slab_m = 0.02;  // the next floor itself is left out
  for (const double next : report.storeys_m) {
    if (next > floor + 1) top = std::min(top, next - slab_m);
  }
  if (options.top_m) top = floor + *options.top_m;
  return {floor, top};
}

/// What to subtract from coordinates that are more than 1 km from the origin, in the plan and in
/// height.
Eigen::Vector3d far_origin_m(const Mesh& mesh) {
  constexpr double far_m = 1000;
  const auto [low, high] = extent_of(mesh);
  const Eigen::Vector3d most = low.cwiseAbs().cwiseMax(high.cwiseAbs());
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (most.head<2>().maxCoeff() > far_m) origin.head<2>() = low.head<2>().array().round();
  if (most.z() > far_m) origin.z() = std::round(low.z());
  return origin;
}

/// To what coordinates are rounded that are nearly all whole millimetres; else 0.
double rounding_m(const Mesh& mesh) {
  constexpr double step_m = 1e-3, off = 0.05, nearly_all = 0.99;
  std::size_t whole = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    for (const double x : v) whole += std::abs(x / step_m - std::round(x / step_m)) < off;
  }
  return static_cast<double>(whole) > nearly_all * 3 * static_cast<double>(mesh.vertices.size())
             ? step_m
             : 0;
}

/// Points where at least two segments end.
std::vector<Eigen::Vector3d> corners_of(const std::vector<Segment>& segments) {
  constexpr double same_m = 1e-3;
  PointGrid grid(0.05);
  std::vector<Eigen::Vector3d> ends;
  std::vector<int> meeting;
  for (const auto& [a, b] : segments) {
    for (const Eigen::Vector3d* end : {&a, &b}) {
      bool known = false;
      grid.visit_near(*end, [&](std::uint32_t i) {
        if (known || (ends[i] - *end).norm() >= same_m) return;
        ++meeting[i];
        known = true;
      });
      if (known) continue;
      grid.add(*end, static_cast<std::uint32_t>(ends.size()));
      ends.push_back(*end);
      meeting.push_back(1);
    }
  }
  std::vector<Eigen::Vector3d> corners;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (meeting[i] > 1) corners.push_back(ends[i]);
  }
  return corners;
}

/// As a world file holds it.
Eigen::Vector3d to_tenth_mm(const Eigen::Vector3d& p) {
  return {std::round(p.x() * 1e4) / 1e4, std::round(p.y() * 1e4) / 1e4,
          std::round(p.z() * 1e4) / 1e4};
}

/// Makes a segment that leans by at most so much upright, unless it would leave the surfaces at
/// which it lies: those stay as they are, and hide what is behind them. Returns whether it did.
bool put_upright(double most_deg, Segment& segment) {
  // Less than VisibilityOptions::surface_gap_m, 1 mm, by the rounding of both to 0.1 mm.
  constexpr double most_m = 8e-4;
  const double lean_deg = lean_rad(segment.first, segment.second) * 180 / std::numbers::pi;
  if (lean_deg == 0 || lean_deg > most_deg) return false;
  auto [a, b] = segment;
  make_upright(a, b);
  a = to_tenth_mm(a);
  b = to_tenth_mm(b);
  if ((a - segment.first).norm() > most_m || (b - segment.second).norm() > most_m) return false;
  segment = {a, b};
  return true;
}

}  // namespace

ImportedWorld import_world(const Mesh& file,
                           const ImportOptions& options,
                           const std::string& place) {
  check(file, place);
  const Mesh mesh = with_used_vertices(file);
  ImportedWorld imported;
  ImportReport& report = imported.report;
  report.vertices = file.vertices.size();
  report.triangles = mesh.triangles.size();
  report.lines = mesh.lines.size();
  report.axes = axes_and_unit(mesh, options.up_axis, options.unit_m, place);
  Mesh building = upright(mesh, report.axes);
  if (const double step_m = mesh.step * report.axes.unit_m; step_m > weld_m) {
    throw Error(place,
                fmt::format("is so far from its origin that its reader rounds to {:.2g} m", step_m),
                "move the building to the origin, or export PLY with doubles");
  }
  const Eigen::Vector3d origin = far_origin_m(building);
  report.moved_m = origin.head<2>();
  const double lift = origin.z();
  for (Eigen::Vector3d& v : building.vertices) {
    v -= origin;
    if (vernier::internal::all_within(v, largest_coordinate_m)) continue;
    throw Error(place,
                fmt::format("is larger than {:g} km with a unit of {:g} m",
                            largest_coordinate_m / 1000, report.axes.unit_m),
                "give --unit, or export one building");
  }
  CreaseOptions crease;
  crease.crease_rad = options.crease_deg * std::numbers::pi / 180;
  crease.rounding_m = rounding_m(building);
  const bool may_lean = !options.is_level && !options.floor_m;
  if (const auto up = may_lean ? leaning_up(building) : std::nullopt) {
    report.levelled_deg = lean_rad(Eigen::Vector3d::Zero(), *up) * 180 / std::numbers::pi;
    building = levelled(std::move(building), *up);
  }
  building = welded(building, weld_m);
  std::vector<Polygon> faces = convex_faces(building);
  const auto [floor, top] = heights_of(options, building, faces, lift, place, report);
  report.floor_slope_deg = floor_slope_rad(building, floor) * 180 / std::numbers::pi;
  for (Eigen::Vector3d& v : building.vertices) v.z() -= floor;
  for (Polygon& face : faces) {
    for (Eigen::Vector3d& v : face) v.z() -= floor;
  }
  report.floor_m = floor + lift;
  if (std::isfinite(top)) report.top_m = top + lift;
  for (double& storey : report.storeys_m) storey += lift;

  constexpr double below_m = 0.01;  // the floor itself, and what stands on it
  FeatureSet& features = imported.world.loose;
  const std::vector<Segment> edges = crease_edges(building, crease, &report.creases);
  report.edges = edges.size();
  for (const Segment& edge : edges) {
    const auto [a, b] = between(edge, -below_m, top - floor);
    const double length = (b - a).norm();
    if (length == 0) {
      ++report.outside;
      if (std::max(edge.first.z(), edge.second.z()) <= -below_m) ++report.below;
    } else if (length < options.shortest_m - weld_m) {  // rounding must not decide
      ++report.shorter;
    } else {
      features.segments_m.emplace_back(to_tenth_mm(a), to_tenth_mm(b));
    }
  }
  for (const Polygon& face : faces) {
    Polygon part = between(face, -below_m, top - floor);
    for (Eigen::Vector3d& p : part) p = to_tenth_mm(p);
    if (part.empty() || surface_error(part)) continue;
    features.surfaces_m.push_back(std::move(part));
  }
  for (Segment& segment : features.segments_m) {
    report.made_upright += put_upright(options.upright_deg, segment);
  }
  features.corners_m = corners_of(features.segments_m);
  if (features.segments_m.empty()) {
    throw Error(place,
                fmt::format("has no edges of at least {:g} m in the storey (floor at {:g} m)",
                            options.shortest_m, floor),
                "choose another storey or floor, or another unit");
  }
  if (const auto fault = size_error(imported.world))
    throw Error(place, fault->fault, fault->remedy);
  return imported;
}

}  // namespace vernier::sim::internal
