// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/crease_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>

#include "sim/import/mesh.h"
#include "sim/import/point_grid.h"

namespace vernier::sim::internal {

namespace {

using Vertex = std::uint32_t;

/// A piece of an edge between neighbouring vertices, and the half-plane of a triangle on it.
struct Piece {
  Vertex a, b;           // ascending
  Eigen::Vector3d into;  // unit, across the edge into the triangle; zero for a line of its own
};

/// Vertices on an edge, from one end to the other.
class EdgeCutter {
 public:
  EdgeCutter(const Mesh& mesh, double within)
      : mesh_(mesh), within_(within), cell_(cell_of(mesh)), grid_(cell_) {
    for (Vertex i = 0; i < mesh.vertices.size(); ++i) grid_.add(mesh.vertices[i], i);
  }

  void cut(Vertex from, Vertex to, std::vector<Vertex>& chain) const {
    const Eigen::Vector3d a = mesh_.vertices[from], d = mesh_.vertices[to] - a;
    const double length = d.norm();
    std::vector<std::pair<double, Vertex>> on;
    for (double s = 0; s < length + cell_; s += cell_) {
      grid_.visit_near(a + d * std::min(1.0, s / length), [&](Vertex v) {
        const Eigen::Vector3d p = mesh_.vertices[v] - a;
        const double along = p.dot(d) / length;
        if (v == from || v == to || along <= 0 || along >= length) return;
        if ((p - along / length * d).norm() < within_) on.emplace_back(along, v);
      });
    }
    std::sort(on.begin(), on.end());
    on.erase(std::unique(on.begin(), on.end()), on.end());
    chain.assign(1, from);
    for (const auto& [along, v] : on) chain.push_back(v);
    chain.push_back(to);
  }

 private:
  /// About a quarter of a mean edge, so that all of them together cross few cells.
  static double cell_of(const Mesh& mesh) {
    constexpr double smallest_m = 0.25;
    double length = 0;
    const auto add = [&](Vertex a, Vertex b) {
      length += (mesh.vertices[a] - mesh.vertices[b]).norm();
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      add(a, b);
      add(b, c);
      add(c, a);
    }
    for (const auto& [a, b] : mesh.lines) add(a, b);
    const auto edges = static_cast<double>(3 * mesh.triangles.size() + mesh.lines.size());
    return edges > 0 ? std::max(smallest_m, 0.25 * length / edges) : smallest_m;
  }

  const Mesh& mesh_;
  double within_, cell_;
  PointGrid grid_;
};

std::vector<Piece> pieces_of(const Mesh& mesh, double within) {
  const EdgeCutter cutter(mesh, within);
  std::vector<Piece> pieces;
  std::vector<Vertex> chain;
  std::map<std::pair<Vertex, Vertex>, std::vector<Vertex>> cut;
  const auto add = [&](Vertex from, Vertex to, const Eigen::Vector3d& into) {
    const auto edge = std::minmax(from, to);
    auto found = cut.find(edge);
    if (found == cut.end()) {
      cutter.cut(edge.first, edge.second, chain);
      found = cut.emplace(edge, chain).first;
    }
    const std::vector<Vertex>& ends = found->second;
    for (std::size_t i = 1; i < ends.size(); ++i) {
      const auto [a, b] = std::minmax(ends[i - 1], ends[i]);
      pieces.push_back({a, b, into});
    }
  };
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vertex from = t[k], to = t[(k + 1) % 3];
      const Eigen::Vector3d& a = mesh.vertices[from];
      const Eigen::Vector3d d = (mesh.vertices[to] - a).normalized();
      const Eigen::Vector3d p = mesh.vertices[t[(k + 2) % 3]] - a;
      add(from, to, (p - d.dot(p) * d).normalized());
    }
  }
  for (const auto& [from, to] : mesh.lines) add(from, to, Eigen::Vector3d::Zero());
  std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& x, const Piece& y) {
    return std::tie(x.a, x.b) < std::tie(y.a, y.b);
  });
  return pieces;
}

/// How the half-planes around a piece look.
struct Crease {
  bool is_edge = true;
  double turn_rad = std::numbers::pi;  ///< from one plane to the other, if there are two
};

Crease crease_of(std::vector<Piece>::const_iterator begin,
                 std::vector<Piece>::const_iterator end,
                 double crease_rad) {
  constexpr double same_rad = 0.05;
  std::vector<Eigen::Vector3d> different;
  for (auto piece = begin; piece != end; ++piece) {
    if (piece->into.isZero()) return {};
    const bool known = std::any_of(different.begin(), different.end(), [&](const auto& other) {
      return other.dot(piece->into) > std::cos(same_rad);
    });
    if (!known) different.push_back(piece->into);
  }
  if (different.size() != 2) return {};
  const double opposite = -different[0].dot(different[1]);
  return {opposite < std::cos(crease_rad), std::acos(std::clamp(opposite, -1.0, 1.0))};
}

bool is_shallow_upright(const Mesh& mesh, const Piece& piece, const Crease& crease) {
  constexpr double shallow_rad = 35 * std::numbers::pi / 180;  // 12 sides turn by 30 degrees
  constexpr double least_m = 1, upright = 1e-3;
  const Eigen::Vector3d d = mesh.vertices[piece.b] - mesh.vertices[piece.a];
  return crease.is_edge && crease.turn_rad < shallow_rad && d.norm() >= least_m &&
         d.head<2>().norm() < upright * d.norm();
}

/// Joins pieces that continue each other.
class Joiner {
 public:
  Joiner(const Mesh& mesh,
         std::vector<std::pair<Vertex, Vertex>> pieces,
         const CreaseOptions& options)
      : mesh_(mesh), options_(options), pieces_(std::move(pieces)), used_(pieces_.size()) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      of_vertex_[pieces_[i].first].push_back(i);
      of_vertex_[pieces_[i].second].push_back(i);
    }
  }

  std::vector<Segment> joined() {
    std::vector<Segment> segments;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (used_[i]) continue;
      used_[i] = true;
      std::vector<Vertex> chain{pieces_[i].first, pieces_[i].second};
      extend(chain);
      std::reverse(chain.begin(), chain.end());
      extend(chain);
      segments.emplace_back(mesh_.vertices[chain.front()], mesh_.vertices[chain.back()]);
    }
    return segments;
  }

 private:
  /// Adds to the end of a chain what continues it: in the direction of its last piece, or, since
  /// rounding turns short pieces, of all of it as far as rounded ends allow.
  void extend(std::vector<Vertex>& chain) {
    for (;;) {
      const Vertex end = chain.back();
      const Eigen::Vector3d last = direction(chain[chain.size() - 2], end);
      const Eigen::Vector3d all = direction(chain.front(), end);
      double best = 0;
      std::size_t next = pieces_.size();
      for (const std::size_t i : of_vertex_[end]) {
        if (used_[i]) continue;
        const Eigen::Vector3d d = direction(end, other(i, end));
        const double straight = std::max(last.dot(d), all.dot(d));
        const bool continues = last.dot(d) > std::cos(options_.straight_rad) ||
                               all.dot(d) > std::cos(rounded_rad(chain, other(i, end)));
        if (continues && straight > best) {
          best = straight;
          next = i;
        }
      }
      if (next == pieces_.size()) return;
      chain.push_back(other(next, end));
      if (!is_straight(chain)) {
        chain.pop_back();
        return;
      }
      used_[next] = true;
    }
  }
  /// By how much a straight chain and a piece at its end may turn because coordinates are rounded.
  double rounded_rad(const std::vector<Vertex>& chain, Vertex next) const {
    const Eigen::Vector3d &a = mesh_.vertices[chain.front()], &b = mesh_.vertices[chain.back()];
    const double rad = options_.rounding_m / std::max((b - a).norm(), 1e-9) +
                       options_.rounding_m / std::max((mesh_.vertices[next] - b).norm(), 1e-9);
    return std::min(rad, options_.most_rounded_rad);
  }
  bool is_straight(const std::vector<Vertex>& chain) const {
    const Eigen::Vector3d a = mesh_.vertices[chain.front()];
    const Eigen::Vector3d d = direction(chain.front(), chain.back());
    return std::all_of(chain.begin(), chain.end(), [&](Vertex v) {
      const Eigen::Vector3d p = mesh_.vertices[v] - a;
      return (p - d.dot(p) * d).norm() < 2 * options_.within_m;
    });
  }
  Vertex other(std::size_t piece, Vertex end) const {
    return pieces_[piece].first == end ? pieces_[piece].second : pieces_[piece].first;
  }
  Eigen::Vector3d direction(Vertex from, Vertex to) const {
    return (mesh_.vertices[to] - mesh_.vertices[from]).normalized();
  }

  const Mesh& mesh_;
  CreaseOptions options_;
  std::vector<std::pair<Vertex, Vertex>> pieces_;
  std::vector<bool> used_;
  std::map<Vertex, std::vector<std::size_t>> of_vertex_;
};

}  // namespace

std::vector<Segment> crease_edges(const Mesh& mesh,
                                  const CreaseOptions& options,
                                  CreaseRemarks* remarks) {
  const std::vector<Piece> pieces = pieces_of(mesh, options.within_m);
  std::vector<std::pair<Vertex, Vertex>> kept;
  for (auto begin = pieces.begin(); begin != pieces.end();) {
    const auto end = std::find_if(begin, pieces.end(), [&](const Piece& piece) {
      return piece.a != begin->a || piece.b != begin->b;
    });
    const Crease crease = crease_of(begin, end, options.crease_rad);
    if (crease.is_edge) kept.emplace_back(begin->a, begin->b);
    if (remarks != nullptr) {
      remarks->shallow_uprights += is_shallow_upright(mesh, *begin, crease);
    }
    begin = end;
  }
  return Joiner(mesh, std::move(kept), options).joined();
}

}  // namespace vernier::sim::internal
