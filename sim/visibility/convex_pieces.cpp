// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/convex_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "calib/base/plane_vectors.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using vernier::internal::cross;

namespace {

using Points = std::vector<Eigen::Vector2d>;
using Loop = std::vector<int>;
using Cuts = std::vector<std::pair<int, int>>;

constexpr double straight_m = 1e-9;  ///< tolerance of a vertex to the line of its neighbours
constexpr double min_width_m = 1e-10;

/// Signed distance of `v` from the line from `u` to `w`: positive for a convex vertex of a
/// counter-clockwise loop.
double bulge(const Eigen::Vector2d& u, const Eigen::Vector2d& v, const Eigen::Vector2d& w) {
  const double length = std::max({(w - u).norm(), (v - u).norm(), (w - v).norm()});
  return length > 0 ? cross(v - u, w - v) / length : 0;
}

double bulge_at(const Points& points, const Loop& loop, std::size_t i) {
  const std::size_t n = loop.size();
  return bulge(points[loop[(i + n - 1) % n]], points[loop[i]], points[loop[(i + 1) % n]]);
}

bool is_convex(const Points& points, const Loop& loop) {
  // Left turns alone would also accept a loop that winds twice, which is not simple.
  for (std::size_t i = 0; i < loop.size(); ++i) {
    if (bulge_at(points, loop, i) < -straight_m) return false;
  }
  return true;
}

/// Right-handed coordinates in the plane with `normal` as third axis.
Points flatten(const std::vector<Eigen::Vector3d>& polygon, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
  Points points;
  points.reserve(polygon.size());
  for (const Eigen::Vector3d& p : polygon) {
    const Eigen::Vector3d r = p - polygon.front();
    points.emplace_back(x.dot(r), y.dot(r));
  }
  return points;
}

/// Corners of a loop as ears, found in turn: of a corner that is none, the vertex in its way is
/// known until that or a neighbour is clipped, so that few corners are looked at twice.
class Ears {
 public:
  Ears(const Points& points, const Loop& loop)
      : points_(points), in_the_way_(points.size(), none), is_left_(points.size()) {
    for (const int v : loop) is_left_[v] = 1;
  }

  bool is_ear(const Loop& loop, std::size_t i) {
    int& known = in_the_way_[loop[i]];
    if (known == none || !is_left_[known]) known = vertex_within(loop, i);
    return known == none;
  }

  void clip(int u, int v, int w) {
    is_left_[v] = 0;
    in_the_way_[u] = in_the_way_[w] = none;
  }

 private:
  static constexpr int none = -1;

  int vertex_within(const Loop& loop, std::size_t i) const {
    const std::size_t n = loop.size();
    const Eigen::Vector2d &u = points_[loop[(i + n - 1) % n]], &v = points_[loop[i]],
                          &w = points_[loop[(i + 1) % n]];
    for (const int j : loop) {
      const Eigen::Vector2d& p = points_[j];
      // The two ends of a cut that joins a hole are the same point twice.
      const double same = straight_m * straight_m;
      if ((p - u).squaredNorm() <= same || (p - v).squaredNorm() <= same ||
          (p - w).squaredNorm() <= same) {
        continue;
      }
      if (bulge(u, v, p) >= -straight_m && bulge(v, w, p) >= -straight_m &&
          bulge(w, u, p) >= -straight_m) {
        return j;
      }
    }
    return none;
  }

  const Points& points_;
  std::vector<int> in_the_way_;
  std::vector<char> is_left_;
};

/// The vertex to clip: one without area, else an ear, else the most convex one (only for invalid
/// loops).
std::size_t vertex_to_clip(const Points& points, const Loop& loop, Ears& ears) {
  std::size_t most = 0;
  double max_bulge = -1e300;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double b = bulge_at(points, loop, i);
    if (std::abs(b) <= straight_m) return i;
    if (b > 0 && ears.is_ear(loop, i)) return i;
    if (b > max_bulge) {
      most = i;
      max_bulge = b;
    }
  }
  return most;
}

std::vector<Loop> triangulate(const Points& points, Loop loop, Cuts& cuts) {
  std::vector<Loop> triangles;
  Ears ears(points, loop);
  while (loop.size() >= 3) {
    const std::size_t n = loop.size(), i = vertex_to_clip(points, loop, ears);
    const int u = loop[(i + n - 1) % n], v = loop[i], w = loop[(i + 1) % n];
    if (bulge(points[u], points[v], points[w]) > straight_m) {
      triangles.push_back({u, v, w});
      if (n > 3) cuts.emplace_back(u, w);
    }
    if (n == 3) break;
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
    ears.clip(u, v, w);
  }
  return triangles;
}

/// The piece with the directed edge u -> v, rotated to begin with v and end with u.
std::size_t piece_with_edge(std::vector<Loop>& pieces, int u, int v) {
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    Loop& loop = pieces[k];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (loop[i] != u || loop[(i + 1) % loop.size()] != v) continue;
      std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>((i + 1) % loop.size()),
                  loop.end());
      return k;
    }
  }
  return pieces.size();
}

void take_back_cut(const Points& points, std::vector<Loop>& pieces, int u, int v) {
  const std::size_t one = piece_with_edge(pieces, u, v), other = piece_with_edge(pieces, v, u);
  if (one == other || one == pieces.size() || other == pieces.size()) return;
  Loop joined = pieces[one];  // v … u, then what follows u in the other up to v
  joined.insert(joined.end(), pieces[other].begin() + 1, pieces[other].end() - 1);
  if (!is_convex(points, joined)) return;
  pieces[one] = std::move(joined);
  pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(other));
}

}  // namespace

PolygonPlane polygon_plane(const std::vector<Eigen::Vector3d>& polygon_m) {
  PolygonPlane plane;
  if (polygon_m.size() < 3) return plane;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double width = 0;
  for (std::size_t i = 1; i < polygon_m.size(); ++i) {
    const Eigen::Vector3d r = polygon_m[i] - polygon_m[0];
    width = std::max(width, r.norm());
    if (i + 1 < polygon_m.size()) sum += r.cross(polygon_m[i + 1] - polygon_m[0]);
  }
  // Twice the area over the extent bounds the height; the negated test also rejects NaN.
  if (!(sum.norm() > min_width_m * width) || !sum.allFinite()) return plane;
  plane.normal = sum.normalized();
  for (const Eigen::Vector3d& p : polygon_m) plane.distance_m += plane.normal.dot(p);
  plane.distance_m /= static_cast<double>(polygon_m.size());
  return plane;
}

bool inside_outline(const Eigen::Vector3d& at_m,
                    const std::vector<Eigen::Vector3d>& polygon_m,
                    int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  bool inside = false;
  for (std::size_t i = 0, j = polygon_m.size() - 1; i < polygon_m.size(); j = i++) {
    const Eigen::Vector3d &a = polygon_m[i], &b = polygon_m[j];
    if ((a[v] > at_m[v]) != (b[v] > at_m[v]) &&
        at_m[u] < (b[u] - a[u]) * (at_m[v] - a[v]) / (b[v] - a[v]) + a[u]) {
      inside = !inside;
    }
  }
  return inside;
}

std::vector<std::vector<int>> convex_pieces(const std::vector<Eigen::Vector3d>& polygon_m) {
  const PolygonPlane plane = polygon_plane(polygon_m);
  if (plane.normal.isZero()) return {};
  const Points points = flatten(polygon_m, plane.normal);
  Loop loop;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    const Eigen::Vector2d& next = points[(i + 1) % points.size()];
    if ((next - points[i]).norm() > straight_m) loop.push_back(i);
  }
  if (loop.size() < 3) return {};
  if (is_convex(points, loop)) return {loop};
  Cuts cuts;
  std::vector<Loop> pieces = triangulate(points, loop, cuts);
  for (const auto& [u, v] : cuts) take_back_cut(points, pieces, u, v);
  return pieces;
}

ConvexSurfaces convex_surfaces(const World& world) {
  ConvexSurfaces surfaces;
  for (const WorldSurface& surface : world.surfaces) {
    const PolygonPlane plane = polygon_plane(surface.polygon_m);
    for (const std::vector<int>& loop : convex_pieces(surface.polygon_m)) {
      ConvexSurface piece{plane.normal,
                          plane.distance_m,
                          Eigen::Vector3d::Zero(),
                          0,
                          static_cast<int>(surfaces.vertices_m.size()),
                          static_cast<int>(loop.size())};
      for (int i : loop) {
        surfaces.vertices_m.push_back(surface.polygon_m[i]);
        piece.centre_m += surface.polygon_m[i] / static_cast<double>(loop.size());
      }
      for (int i : loop) {
        piece.radius_m = std::max(piece.radius_m, (surface.polygon_m[i] - piece.centre_m).norm());
      }
      surfaces.pieces.push_back(piece);
    }
  }
  return surfaces;
}

Eigen::AlignedBox3d box_of(const ConvexSurfaces& surfaces, const ConvexSurface& piece) {
  Eigen::AlignedBox3d box;
  for (int k = 0; k < piece.vertex_count; ++k) {
    box.extend(surfaces.vertices_m[piece.first_vertex + k]);
  }
  return box;
}

}  // namespace vernier::sim::internal
