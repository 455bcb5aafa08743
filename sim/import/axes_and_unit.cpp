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
#include <utility>
#include <vector>

#include "calib/error.h"
#include "sim/import/convex_faces.h"
#include "sim/import/even_storeys.h"
#include "sim/import/levels.h"
#include "sim/import/mesh.h"
#include "sim/import/storeys.h"

namespace vernier::sim::internal {

namespace {

/// A unit of length, and how high a building of one storey may be with it. Ranges of two units that
/// overlap make the program ask: a hall of 10 m is one of 3.05 m if its unit is a foot. A metre has
/// the widest, being the commonest; those of a millimetre and a centimetre just do not overlap.
struct Unit {
  double metres;
  const char* name;
  double lowest_m, highest_m;
};
constexpr std::array units{Unit{1, "m", 1.8, 60}, Unit{0.01, "cm", 2.2, 22},
                           Unit{0.001, "mm", 2.2, 60}, Unit{0.0254, "in", 2.2, 22},
                           Unit{0.3048, "ft", 2.2, 22}};
constexpr double highest_storey_m = 6;                       // of several, from floor to floor
constexpr double shortest_plan_m = 3, longest_plan_m = 500;  // the longer side of the plan

/// What stands along an axis: its lower and upper end, and how much of it there is.
struct UprightFace {
  double low, high, amount;
};

std::vector<UprightFace> uprights(const Mesh& mesh, int axis) {
  std::vector<UprightFace> found;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Eigen::Vector3d twice = (q - p).cross(r - p);
    if (std::abs(twice[axis]) > wall_cosine * twice.norm()) continue;
    const auto [low, high] = std::minmax({p[axis], q[axis], r[axis]});
    found.push_back({low, high, twice.norm()});
  }
  if (!mesh.triangles.empty()) return found;
  for (const auto& [a, b] : mesh.lines) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
    if (std::abs(q[axis] - p[axis]) < floor_cosine * (q - p).norm()) continue;
    const auto [low, high] = std::minmax(p[axis], q[axis]);
    found.push_back({low, high, high - low});
  }
  return found;
}

/// Where heights along an axis lie in the building or, folded, in the storey of theirs: 0 to 1.
struct Heights {
  double low = 0, size = 0;
  bool is_folded = false;

  double share(double height) const {
    if (!(size > 0)) return 0;
    const double share = (height - low) / size;
    return is_folded ? share - std::floor(share) : std::clamp(share, 0.0, 1.0);
  }
};

/// Takes out what is most at a height: in a slice or, in folded heights, which have no ends, in two
/// neighbours, lest rounding decides between them.
template <std::size_t count>
double take_commonest(std::array<double, count>& slices, bool is_folded) {
  const auto next = [&](std::size_t i) { return (i + 1) % count; };
  const auto amount = [&](std::size_t i) { return slices[i] + (is_folded ? slices[next(i)] : 0); };
  std::size_t most = 0;
  for (std::size_t i = 1; i < count; ++i) {
    if (amount(i) > amount(most)) most = i;
  }
  const double taken = amount(most);
  slices[most] = 0;
  if (is_folded) slices[next(most)] = 0;
  return taken;
}

/// Share of what stands along an axis that begins at the commonest of 100 heights, times that of
/// what ends at the commonest: walls stand on one floor and reach one ceiling.
double alike(const std::vector<UprightFace>& uprights, const Heights& heights) {
  std::array<double, 101> begins{}, ends{};
  double all = 0;
  const auto at = [&](double height) {
    return static_cast<std::size_t>(std::lround(100 * heights.share(height)));
  };
  for (const UprightFace& upright : uprights) {
    begins[at(upright.low)] += upright.amount;
    ends[at(upright.high)] += upright.amount;
    all += upright.amount;
  }
  if (!(all > 0)) return 0;
  return take_commonest(begins, heights.is_folded) * take_commonest(ends, heights.is_folded) /
         (all * all);
}

/// Share of the surface (or of the lines, without any) that is level with respect to an axis and
/// lies at the two commonest of 60 heights: floors and ceilings.
double gathered(const Mesh& mesh, int axis, const Heights& heights) {
  std::array<double, 60> slices{};
  double all = 0;
  const auto add = [&](double at, double amount) {
    slices[std::min<std::size_t>(59, static_cast<std::size_t>(60 * heights.share(at)))] += amount;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Eigen::Vector3d twice = (q - p).cross(r - p);
    const double area = twice.norm();
    all += area;
    if (std::abs(twice[axis]) > floor_cosine * area) add((p[axis] + q[axis] + r[axis]) / 3, area);
  }
  if (mesh.triangles.empty()) {
    for (const auto& [a, b] : mesh.lines) {
      const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
      const double length = (q - p).norm();
      all += length;
      if (std::abs(q[axis] - p[axis]) < 0.02 * length) add(p[axis], length);
    }
  }
  const double first = take_commonest(slices, heights.is_folded);
  return all > 0 ? (first + take_commonest(slices, heights.is_folded)) / all : 0;
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

/// The same mesh 10 m large, and welded.
Mesh of_one_size(Mesh mesh) {
  constexpr double size_m = 10, weld_m = 1e-4;
  const auto [low, high] = extent_of(mesh);
  // squares of the smallest coordinates would be 0
  const double scale = size_m / std::max((high - low).stableNorm(), 1e-300);
  for (Eigen::Vector3d& v : mesh.vertices) v = scale * (v - low);
  return welded(mesh, weld_m);
}

/// The same mesh with its faces joined where they lie in a plane, each as a fan of triangles: a
/// wall of small triangles reaches from floor to ceiling like one of two.
Mesh with_joined_faces(const Mesh& mesh) {
  Mesh joined;
  joined.lines = mesh.lines;
  if (!mesh.lines.empty()) joined.vertices = mesh.vertices;
  for (const Polygon& face : convex_faces(mesh)) {
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
/// surface at few heights, and the smallest height.
std::optional<int> voted_axis(const Mesh& mesh, const std::array<Heights, 3>& heights) {
  std::array<double, 3> by_walls{}, by_floors{}, by_size{};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = std::max(heights[axis].size, 1e-300);
    by_walls[axis] = alike(uprights(mesh, axis), heights[axis]) / size;
    by_floors[axis] = gathered(mesh, axis, heights[axis]);
    by_size[axis] = 1 / size;
  }
  std::array<int, 3> votes{};
  for (const std::optional<int>& sign :
       {clear_winner(by_walls, 1.15), clear_winner(by_floors, 1.3), clear_winner(by_size, 1.2)}) {
    if (sign) ++votes[*sign];
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (votes[axis] >= 2) return axis;
  }
  return {};
}

using FloorsByAxis = std::array<std::optional<InnerFloors>, 3>;

/// Whether the plan is wider than a storey is high if this axis is up: rooms in a row, each a box,
/// are no storeys of a narrow tower.
bool is_wide(const FloorsByAxis& floors, const Eigen::Vector3d& size, int axis) {
  constexpr double least_width = 1.25;  // of a storey's height
  return floors[axis] && std::min(size[(axis + 1) % 3], size[(axis + 2) % 3]) >=
                             least_width * floors[axis]->highest;
}

/// Whether walls may end at floors within the building if this axis is up.
bool may_end(const FloorsByAxis& floors, int axis) {
  constexpr double doubtful = 0.6;  // of their cross-section
  return floors[axis] && floors[axis]->ending >= doubtful;
}

/// The axis along which walls end at floors within the building, and along no other.
std::optional<int> axis_of_floors(const FloorsByAxis& floors, const Eigen::Vector3d& size) {
  constexpr double nearly_all = 0.8;  // of the cross-section of walls
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_clear = floors[axis] && floors[axis]->ending >= nearly_all &&
                          !may_end(floors, (axis + 1) % 3) && !may_end(floors, (axis + 2) % 3);
    if (is_clear && is_wide(floors, size, axis)) return axis;
  }
  return {};
}

/// Whether a building is low and wide: hardly any is so deep, and so many times as high and long.
bool is_plate(const Eigen::Vector3d& size, int axis) {
  constexpr double times = 5;
  return std::min(size[(axis + 1) % 3], size[(axis + 2) % 3]) > times * size[axis];
}

/// The axes for which the signs of a building speak, and those of its storeys folded into one; how
/// many even storeys there are along each.
struct Voted {
  std::optional<int> whole, folded;
  std::array<int, 3> storeys{};
};

Voted voted_axes(const Mesh& mesh) {
  const auto [low, high] = extent_of(mesh);
  Voted voted;
  std::array<Heights, 3> whole, folded;
  for (int axis = 0; axis < 3; ++axis) {
    whole[axis] = folded[axis] = {low[axis], high[axis] - low[axis], false};
    const std::optional<EvenStoreys> storeys = even_storeys(mesh, axis);
    if (!storeys) continue;
    folded[axis] = {storeys->first, storeys->height, true};
    voted.storeys[axis] = storeys->count;
  }
  voted.whole = voted_axis(mesh, whole);
  voted.folded = voted_axis(mesh, folded);
  return voted;
}

/// The axis for which the signs of the whole building speak; unless it is a plate, only if those of
/// its storeys do too, and if more of its walls do not end at floors along another.
std::optional<int> axis_by_signs(const Voted& voted,
                                 const FloorsByAxis& floors,
                                 const Eigen::Vector3d& size) {
  const std::optional<int> up = voted.whole;
  if (!up) return {};
  if (is_plate(size, *up)) {
    // So is a slender tower on its side.
    constexpr int many = 5;
    const auto is_tower = [&](int axis) {
      return voted.storeys[axis] >= many && may_end(floors, axis);
    };
    return is_tower((*up + 1) % 3) || is_tower((*up + 2) % 3) ? std::nullopt : up;
  }
  if (voted.folded != up) return {};
  for (const int other : {(*up + 1) % 3, (*up + 2) % 3}) {
    if (may_end(floors, other) && is_wide(floors, size, other)) return {};
    if (floors[*up] && floors[other] && floors[other]->ending > floors[*up]->ending) return {};
  }
  return up;
}

int up_axis_by_look(const Mesh& file, const std::string& place) {
  const Mesh mesh = of_one_size(file);
  if (mesh.triangles.empty() && mesh.lines.empty()) {
    throw Error(place, "has no surface", "give --up");
  }
  const auto [low, high] = extent_of(mesh);
  const Eigen::Vector3d size = high - low;
  const Triangles triangles = different_triangles(mesh);
  if (const std::optional<int> up = axis_of_ground(mesh, triangles)) return *up;
  FloorsByAxis floors;
  for (int axis = 0; axis < 3; ++axis) floors[axis] = inner_floors(mesh, triangles, axis);
  const Voted voted = voted_axes(with_joined_faces(mesh));
  std::optional<int> up = axis_of_floors(floors, size);
  // Floors seem to end at walls, too, where all are sheets and façades pass by the floors.
  if (!up || (voted.folded != up && is_of_sheets(mesh, triangles)))
    up = axis_by_signs(voted, floors, size);
  if (up && !may_lie(size, *up)) return *up;
  throw Error(place, "does not say which axis is up, and its shape does not show it",
              "say so with --up x, y or z");
}

/// The unit with which the storeys, else the whole height, are those of a building.
const Unit& unit_by_look(const Mesh& mesh, int up, const std::string& place) {
  const auto [low, high] = extent_of(mesh);
  const Eigen::Vector3d size = high - low;
  const double height = size[up], length = std::max(size[(up + 1) % 3], size[(up + 2) % 3]);
  const std::optional<EvenStoreys> storeys = even_storeys(mesh, up);
  const auto is_storey = [&](double unit_m) {
    const double high_m = storeys ? unit_m * storeys->height : 0;
    return high_m >= lowest_storey_m && high_m <= highest_storey_m;
  };
  // Two storeys are found by chance too: but for metres, what the whole height allows counts
  // beside.
  const bool is_sure = storeys && (storeys->count > 2 || is_storey(1));
  for (const bool by_storeys : {true, false}) {
    if (by_storeys && !storeys) continue;
    std::vector<const Unit*> fit;
    std::string sizes;
    for (const Unit& unit : units) {
      const double whole_m = unit.metres * height, length_m = unit.metres * length;
      const bool by_whole = whole_m >= unit.lowest_m && whole_m <= unit.highest_m;
      const bool is_high = by_storeys ? is_storey(unit.metres) || (!is_sure && by_whole) : by_whole;
      if (!is_high || length_m < shortest_plan_m || length_m > longest_plan_m) continue;
      fit.push_back(&unit);
      sizes += fmt::format("{}{} ({:.3g} m long, {:.3g} m high)", sizes.empty() ? "" : " or ",
                           unit.name, length_m, whole_m);
    }
    if (fit.size() == 1) return *fit[0];
    if (fit.size() > 1) {
      throw Error(place, "does not say its unit of length, which may be " + sizes,
                  "say which with --unit");
    }
  }
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
    axes.up_because = mesh.up_because;
  } else {
    axes.up_axis = up_axis_by_look(mesh, place);
    axes.up_because = "by its shape";
  }
  if (given_unit_m) {
    axes.unit_m = *given_unit_m;
    axes.unit_because = "given";
  } else if (mesh.unit_m) {
    axes.unit_m = *mesh.unit_m;
    axes.unit_because = mesh.unit_because;
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
