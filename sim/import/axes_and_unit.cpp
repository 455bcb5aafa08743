// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/axes_and_unit.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "sim/import/convex_faces.h"
#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

struct Unit {
  double metres;
  const char* name;
};
constexpr std::array units{Unit{1, "m"}, Unit{0.01, "cm"}, Unit{0.001, "mm"}, Unit{0.0254, "in"},
                           Unit{0.3048, "ft"}};

/// What stands along an axis: its lower and upper end, and how much of it there is.
struct Upright {
  double low, high, amount;
};

std::vector<Upright> uprights(const Mesh& mesh, int axis) {
  std::vector<Upright> found;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Eigen::Vector3d twice = (q - p).cross(r - p);
    if (std::abs(twice[axis]) > 0.2 * twice.norm()) continue;
    const auto [low, high] = std::minmax({p[axis], q[axis], r[axis]});
    found.push_back({low, high, twice.norm()});
  }
  if (!mesh.triangles.empty()) return found;
  for (const auto& [a, b] : mesh.lines) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
    if (std::abs(q[axis] - p[axis]) < 0.98 * (q - p).norm()) continue;
    const auto [low, high] = std::minmax(p[axis], q[axis]);
    found.push_back({low, high, high - low});
  }
  return found;
}

/// Share of what stands along an axis that begins at the commonest of 100 heights, times that of
/// what ends at the commonest: walls stand on one floor and reach one ceiling.
double alike(const std::vector<Upright>& uprights, double low, double high) {
  std::array<double, 101> begins{}, ends{};
  double all = 0;
  const auto at = [&](double height) {
    const double share = high > low ? (height - low) / (high - low) : 0;
    return static_cast<std::size_t>(std::lround(100 * std::clamp(share, 0.0, 1.0)));
  };
  for (const Upright& upright : uprights) {
    begins[at(upright.low)] += upright.amount;
    ends[at(upright.high)] += upright.amount;
    all += upright.amount;
  }
  if (!(all > 0)) return 0;
  return *std::max_element(begins.begin(), begins.end()) *
         *std::max_element(ends.begin(), ends.end()) / (all * all);
}

/// Share of the surface (or of the lines, without any) that is level with respect to an axis and
/// lies at the two commonest of 60 heights: floors and ceilings.
double gathered(const Mesh& mesh, int axis, double low, double high) {
  std::array<double, 60> heights{};
  double all = 0;
  const auto add = [&](double at, double amount) {
    const double share = high > low ? (at - low) / (high - low) : 0;
    heights[std::min<std::size_t>(59, static_cast<std::size_t>(std::max(0.0, share * 60)))] +=
        amount;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Eigen::Vector3d twice = (q - p).cross(r - p);
    const double area = twice.norm();
    all += area;
    if (std::abs(twice[axis]) > 0.98 * area) add((p[axis] + q[axis] + r[axis]) / 3, area);
  }
  if (mesh.triangles.empty()) {
    for (const auto& [a, b] : mesh.lines) {
      const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
      const double length = (q - p).norm();
      all += length;
      if (std::abs(q[axis] - p[axis]) < 0.02 * length) add(p[axis], length);
    }
  }
  std::partial_sort(heights.begin(), heights.begin() + 2, heights.end(), std::greater<>());
  return all > 0 ? (heights[0] + heights[1]) / all : 0;
}

/// The axis of the largest value, if it is so many times the second.
std::optional<int> clear_winner(const std::array<double, 3>& values, double times) {
  const auto best =
      static_cast<int>(std::max_element(values.begin(), values.end()) - values.begin());
  for (int axis = 0; axis < 3; ++axis) {
    if (axis != best && !(values[best] > times * values[axis])) return {};
  }
  return best;
}

/// The same mesh 10 m large, with its faces joined where they lie in a plane, each as a fan of
/// triangles: a wall of small triangles reaches from floor to ceiling like one of two.
Mesh with_joined_faces(Mesh mesh) {
  constexpr double size_m = 10, weld_m = 1e-4;
  const auto [low, high] = extent_of(mesh);
  const double scale = size_m / std::max((high - low).norm(), 1e-300);
  for (Eigen::Vector3d& v : mesh.vertices) v = scale * (v - low);
  Mesh joined;
  joined.lines = mesh.lines;
  if (!mesh.lines.empty()) joined.vertices = mesh.vertices;
  for (const Polygon& face : convex_faces(welded(mesh, weld_m))) {
    const auto first = static_cast<std::uint32_t>(joined.vertices.size());
    joined.vertices.insert(joined.vertices.end(), face.begin(), face.end());
    for (std::uint32_t i = 1; i + 1 < face.size(); ++i) {
      joined.triangles.push_back({first, first + i, first + i + 1});
    }
  }
  return joined;
}

/// Whether a building may lie on its side if this axis, its shortest, is up: a corridor, whose
/// walls are alike, level if it lies, and as few as floors.
bool may_lie(const Eigen::Vector3d& size, int axis) {
  constexpr double narrow = 2.5, corridor = 3;  // times the width
  Eigen::Vector3d sorted = size;
  std::sort(sorted.begin(), sorted.end());
  return size[axis] == sorted[0] && sorted[1] < narrow * sorted[0] &&
         sorted[2] > corridor * sorted[1];
}

/// The axis for which two of three signs speak: walls that begin and end alike and are low, level
/// surface at few heights, and the shortest extent.
int up_axis_by_look(const Mesh& file, const std::string& place) {
  const Mesh mesh = with_joined_faces(file);
  if (mesh.vertices.empty()) throw Error(place, "has no surface", "give --up");
  const auto [low, high] = extent_of(mesh);
  std::array<double, 3> by_walls{}, by_floors{}, by_size{};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = std::max(high[axis] - low[axis], 1e-300);
    by_walls[axis] = alike(uprights(mesh, axis), low[axis], high[axis]) / size;
    by_floors[axis] = gathered(mesh, axis, low[axis], high[axis]);
    by_size[axis] = 1 / size;
  }
  std::array<int, 3> votes{};
  for (const std::optional<int>& sign :
       {clear_winner(by_walls, 1.15), clear_winner(by_floors, 1.3), clear_winner(by_size, 1.2)}) {
    if (sign) ++votes[*sign];
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (votes[axis] >= 2 && !may_lie(high - low, axis)) return axis;
  }
  throw Error(place, "does not say which axis is up, and its shape does not show it",
              "say so with --up x, y or z");
}

/// Sizes in metres with a unit: height, and the longer side of the plan.
std::pair<double, double> height_and_length_m(const Mesh& mesh, int up, double unit_m) {
  const auto [low, high] = extent_of(mesh);
  const Eigen::Vector3d size = unit_m * (high - low);
  return {size[up], std::max(size[(up + 1) % 3], size[(up + 2) % 3])};
}

const Unit& unit_by_look(const Mesh& mesh, int up, const std::string& place) {
  for (const double highest : {8.0, 60.0}) {
    std::vector<const Unit*> fit;
    std::string sizes;
    for (const Unit& unit : units) {
      const auto [height, length] = height_and_length_m(mesh, up, unit.metres);
      if (!(height >= 1.8 && height <= highest && length >= 3 && length <= 500)) continue;
      fit.push_back(&unit);
      sizes += fmt::format("{}{} ({:.3g} m long, {:.3g} m high)", sizes.empty() ? "" : " or ",
                           unit.name, length, height);
    }
    if (fit.size() == 1) return *fit[0];
    if (fit.size() > 1) {
      throw Error(place, "does not say its unit of length, which may be " + sizes,
                  "say which with --unit");
    }
  }
  const auto [height, length] = height_and_length_m(mesh, up, 1);
  throw Error(place,
              fmt::format("does not say its unit of length, and {:.3g} units long and {:.3g} high "
                          "it is no building in m, cm, mm, in or ft",
                          length, height),
              "give --unit");
}

}  // namespace

AxesAndUnit axes_and_unit(const Mesh& mesh,
                          std::optional<int> given_up,
                          std::optional<double> given_unit_m,
                          const std::string& place) {
  AxesAndUnit axes;
  if (given_up) {
    axes.up_axis = *given_up;
    axes.up_because = "given";
  } else if (mesh.up_axis) {
    axes.up_axis = *mesh.up_axis;
    axes.up_because = "by the file";
  } else {
    axes.up_axis = up_axis_by_look(mesh, place);
    axes.up_because = "by its shape";
  }
  if (given_unit_m) {
    axes.unit_m = *given_unit_m;
    axes.unit_because = "given";
  } else if (mesh.unit_m) {
    axes.unit_m = *mesh.unit_m;
    axes.unit_because = "by the file";
  } else {
    axes.unit_m = unit_by_look(mesh, axes.up_axis, place).metres;
    axes.unit_because = "by its size";
  }
  return axes;
}

Mesh upright(Mesh mesh, const AxesAndUnit& axes) {
  for (Eigen::Vector3d& v : mesh.vertices) {
    if (axes.up_axis == 1) v = Eigen::Vector3d(v.x(), -v.z(), v.y());
    if (axes.up_axis == 0) v = Eigen::Vector3d(-v.z(), v.y(), v.x());
    v *= axes.unit_m;
  }
  return mesh;
}

}  // namespace vernier::sim::internal
