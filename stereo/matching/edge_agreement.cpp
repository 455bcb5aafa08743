// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/edge_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stereo/edges/connected_sets.h"
#include "stereo/edges/edge_points_by_row.h"

namespace vernier::stereo::internal {
namespace {

/// Groups of matched points that are close and agree, built row by row.
class Chains {
 public:
  Chains(const PointsByRow& points, int reach, double slope, const std::vector<float>& disparity)
      : points_(points), reach_(reach), slope_(slope), disparity_(disparity) {
    for (int p = 0; p < points.size(); ++p) sets_.add();
  }

  /// To be called for the rows in order.
  void add_row(int y) {
    std::vector<int> from;  // first candidate of each row above
    for (int j = std::max(0, y - reach_); j < y; ++j) {
      from.push_back(row_begin_[static_cast<std::size_t>(j)]);
    }
    const auto row = static_cast<std::size_t>(y);
    for (int p = points_.row_begin[row]; p < points_.row_begin[row + 1]; ++p) {
      if (std::isnan(disparity_[static_cast<std::size_t>(p)])) continue;
      for (std::size_t j = 0; j < from.size(); ++j) {
        join_near(p, from[j], row_begin_[row - from.size() + j + 1]);
      }
      const auto end = static_cast<int>(matched_.size());
      int own = std::max(row_begin_[row], end - reach_);
      join_near(p, own, end);
      matched_.push_back(p);
    }
    row_begin_.push_back(static_cast<int>(matched_.size()));
  }

  /// Matched points in smaller groups.
  std::vector<int> of_fewer_than(int least) {
    std::vector<int> size(disparity_.size(), 0), few;
    for (const int p : matched_) ++size[static_cast<std::size_t>(sets_.root(p))];
    for (const int p : matched_) {
      if (size[static_cast<std::size_t>(sets_.root(p))] < least) few.push_back(p);
    }
    return few;
  }

 private:
  int x_of(int p) const { return points_.x[static_cast<std::size_t>(p)]; }

  /// Joins p with the consistent ones of matched_[begin, end); `begin` follows p to the right.
  void join_near(int p, int& begin, int end) {
    const int x = x_of(p);
    while (begin < end && x_of(matched_[static_cast<std::size_t>(begin)]) < x - reach_) ++begin;
    for (int i = begin; i < end; ++i) {
      const int q = matched_[static_cast<std::size_t>(i)];
      if (x_of(q) > x + reach_) break;
      const double most = 1 + slope_ * std::abs(x_of(q) - x);
      const float off =
          disparity_[static_cast<std::size_t>(q)] - disparity_[static_cast<std::size_t>(p)];
      if (std::abs(off) <= most) sets_.join(p, q);
    }
  }

  const PointsByRow& points_;
  int reach_;
  double slope_;
  const std::vector<float>& disparity_;
  ConnectedSets sets_;
  std::vector<int> matched_, row_begin_{0};  // by row
};

}  // namespace

void remove_isolated(const PointsByRow& points,
                     int min_points,
                     int reach,
                     double slope,
                     std::vector<float>& disparity) {
  Chains chains(points, reach, slope, disparity);
  const auto height = static_cast<int>(points.row_begin.size()) - 1;
  for (int y = 0; y < height; ++y) chains.add_row(y);
  for (const int p : chains.of_fewer_than(min_points)) {
    disparity[static_cast<std::size_t>(p)] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace vernier::stereo::internal
