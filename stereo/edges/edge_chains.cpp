// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/edge_chains.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {
namespace {

constexpr int max_spur_points = 2;

/// The neighbours of each point.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<EdgePoint>& points) : of_(points.size()) {
    for (const EdgePoint& point : points) {
      columns_ = std::max(columns_, point.x + 3);
      rows_ = std::max(rows_, point.y + 3);
    }
    at_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      at_[place(points[i].x, points[i].y)] = static_cast<int>(i);
    }
    for (std::size_t i = 0; i < points.size(); ++i) link(points, static_cast<int>(i));
  }

  int count(int i) const { return of_[i].count; }
  int operator()(int i, int k) const { return of_[i].points[k]; }
  /// The other neighbour of a point that has two.
  int beyond(int i, int other) const { return of_[i].points[of_[i].points[0] == other ? 1 : 0]; }

  void unlink(int a, int b) {
    remove(a, b);
    remove(b, a);
  }

 private:
  struct Links {
    int count = 0;
    std::array<int, 8> points{};
  };

  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x + 1);
  }
  int at(int x, int y) const { return at_[place(x, y)]; }

  void link(const std::vector<EdgePoint>& points, int i) {
    const EdgePoint& own = points[i];
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int other = dx == 0 && dy == 0 ? -1 : at(own.x + dx, own.y + dy);
        if (other < 0 || !(points[other].normal.dot(own.normal) > 0)) continue;
        const bool round_the_corner =
            dx != 0 && dy != 0 && (at(own.x + dx, own.y) >= 0 || at(own.x, own.y + dy) >= 0);
        if (!round_the_corner) of_[i].points[of_[i].count++] = other;
      }
    }
  }

  void remove(int i, int other) {
    Links& links = of_[i];
    auto* const end = links.points.begin() + links.count;
    links.count =
        static_cast<int>(std::remove(links.points.begin(), end, other) - links.points.begin());
  }

  int columns_ = 0, rows_ = 0;
  std::vector<int> at_;
  std::vector<Links> of_;
};

void cut_spurs(Neighbours& neighbours, int points) {
  for (int i = 0; i < points; ++i) {
    if (neighbours.count(i) != 1) continue;
    int before = i, at = neighbours(i, 0), length = 1;
    while (length < max_spur_points && neighbours.count(at) == 2) {
      const int next = neighbours.beyond(at, before);
      before = at;
      at = next;
      ++length;
    }
    if (neighbours.count(at) >= 3) neighbours.unlink(before, at);
  }
}

}  // namespace

std::vector<EdgeChain> edge_chains(const std::vector<EdgePoint>& points) {
  Neighbours neighbours(points);
  const int count = static_cast<int>(points.size());
  cut_spurs(neighbours, count);
  std::vector<EdgeChain> chains;
  std::vector<char> done(points.size(), 0);
  const auto follow = [&](int before, int at, EdgeChain& chain) {
    while (!done[at] && neighbours.count(at) <= 2) {
      done[at] = 1;
      chain.points.push_back(at);
      if (neighbours.count(at) < 2) return;
      const int next = neighbours.beyond(at, before);
      before = at;
      at = next;
    }
  };
  for (int i = 0; i < count; ++i) {  // from their ends and from junctions
    if (neighbours.count(i) == 2) continue;
    for (int k = 0; k < neighbours.count(i); ++k) {
      EdgeChain chain;
      if (neighbours.count(i) == 1) {
        if (done[i]) continue;
        done[i] = 1;
        chain.points.push_back(i);
      }
      follow(i, neighbours(i, k), chain);
      if (!chain.points.empty()) chains.push_back(std::move(chain));
    }
  }
  for (int i = 0; i < count; ++i) {  // the remaining chains are closed
    if (done[i] || neighbours.count(i) != 2) continue;
    EdgeChain chain;
    chain.closed = true;
    follow(neighbours(i, 0), i, chain);
    chains.push_back(std::move(chain));
  }
  return chains;
}

}  // namespace vernier::stereo::internal
