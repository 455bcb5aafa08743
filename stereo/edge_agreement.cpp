// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edge_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace vernier {
namespace {

/// Sets of points, each named by one of them.
class Chains {
 public:
  explicit Chains(std::size_t count) : root_(count), size_(count, 1) {
    std::iota(root_.begin(), root_.end(), 0);
  }
  void join(int a, int b) {
    a = root(a), b = root(b);
    if (a == b) return;
    root_[static_cast<std::size_t>(a)] = b;
    size_[static_cast<std::size_t>(b)] += size_[static_cast<std::size_t>(a)];
  }
  int size_of(int a) { return size_[static_cast<std::size_t>(root(a))]; }

 private:
  int root(int a) {
    while (root_[static_cast<std::size_t>(a)] != a) {
      int& up = root_[static_cast<std::size_t>(a)];
      a = up = root_[static_cast<std::size_t>(up)];
    }
    return a;
  }
  std::vector<int> root_, size_;
};

}  // namespace

void drop_lonely(const PointsByRow& points,
                 int least_points,
                 int reach,
                 double slope,
                 std::vector<float>& disparity) {
  std::vector<int> matched;  // by row
  std::vector<int> row_begin{0};
  Chains chains(points.x.size());
  const auto height = static_cast<int>(points.row_begin.size()) - 1;
  for (int y = 0; y < height; ++y) {
    std::vector<int> from;  // the first of each row above that is not too far left
    for (int j = std::max(0, y - reach); j < y; ++j) {
      from.push_back(row_begin[static_cast<std::size_t>(j)]);
    }
    const auto row = static_cast<std::size_t>(y);
    for (int p = points.row_begin[row]; p < points.row_begin[row + 1]; ++p) {
      const auto k = static_cast<std::size_t>(p);
      if (std::isnan(disparity[k])) continue;
      const int x = points.x[k];
      const auto join_near = [&](int& begin, int end) {
        while (begin < end &&
               points.x[static_cast<std::size_t>(matched[static_cast<std::size_t>(begin)])] <
                   x - reach) {
          ++begin;
        }
        for (int i = begin; i < end; ++i) {
          const int q = matched[static_cast<std::size_t>(i)];
          if (points.x[static_cast<std::size_t>(q)] > x + reach) break;
          const double most = 1 + slope * std::abs(points.x[static_cast<std::size_t>(q)] - x);
          if (std::abs(disparity[static_cast<std::size_t>(q)] - disparity[k]) <= most) {
            chains.join(p, q);
          }
        }
      };
      for (std::size_t j = 0; j < from.size(); ++j) {
        const auto above = static_cast<std::size_t>(y) - from.size() + j;
        join_near(from[j], row_begin[above + 1]);
      }
      int own = row_begin[row];
      const auto end = static_cast<int>(matched.size());
      own = std::max(own, end - reach);
      join_near(own, end);
      matched.push_back(p);
    }
    row_begin.push_back(static_cast<int>(matched.size()));
  }
  for (const int p : matched) {
    if (chains.size_of(p) >= least_points) continue;
    disparity[static_cast<std::size_t>(p)] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace vernier
