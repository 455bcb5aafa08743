// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edge_matcher.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/error.h"
#include "stereo/edge_support.h"

namespace vernier {
namespace {

/// The left points and the disparities found for them, seen from the right image.
class Search {
 public:
  Search(const RectifiedPair& pair, const DisparityRange& range)
      : width_(pair.left.width_px), height_(pair.left.height_px), least_(range.least_px) {
    count_ = (range.most_px - range.least_px + 1 + 31) / 32 * 32;
    const int border = count_ + std::abs(least_) + 2;
    left_ = census_transform(pair.left, border);
    right_ = census_transform(pair.right, border);
    searched_ = range.most_px - range.least_px + 1;
  }

  std::vector<Winner> from_left(const PointsByRow& points) const {
    std::vector<int> first;
    for (const int x : points.x) first.push_back(width_ - 1 - x + least_);
    const CensusImage right = mirrored(right_);
    return semi_global_winners({points, left_, right, first, Facing::opposite, count_});
  }

  /// Whether each left point's place in the right image finds it again, within a disparity.
  std::vector<bool> confirmed(const PointsByRow& points, const std::vector<Winner>& found) const {
    std::vector<int> place(points.x.size(), -1);
    std::vector<int> index(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                           -1);
    std::vector<int> x, y, first;
    for (std::size_t row = 0; row + 1 < points.row_begin.size(); ++row) {
      std::vector<int> seen;
      for (int p = points.row_begin[row]; p < points.row_begin[row + 1]; ++p) {
        const auto k = static_cast<std::size_t>(p);
        const int there = points.x[k] - least_ - found[k].index;
        if (there < 0 || there >= width_ || found[k].index >= searched_) continue;
        place[k] = there;
        seen.push_back(there);
      }
      std::sort(seen.begin(), seen.end());
      seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
      for (const int there : seen) {
        index[row * static_cast<std::size_t>(width_) + static_cast<std::size_t>(there)] =
            static_cast<int>(x.size());
        x.push_back(there);
        y.push_back(static_cast<int>(row));
        first.push_back(there + least_);
      }
    }
    const PointsByRow right = points_by_row(std::move(x), std::move(y), height_);
    const std::vector<Winner> back = semi_global_winners(
        {right, right_, left_, first, Facing::same, count_}, Support::from_above);
    std::vector<bool> same(points.x.size(), false);
    for (std::size_t k = 0; k < same.size(); ++k) {
      if (place[k] < 0) continue;
      const int there =
          index[static_cast<std::size_t>(points.y[k]) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(place[k])];
      same[k] = std::abs(back[static_cast<std::size_t>(there)].index - found[k].index) <= 1;
    }
    return same;
  }

  int least() const { return least_; }

 private:
  int width_, height_, least_, count_ = 0, searched_ = 0;
  CensusImage left_, right_;
};

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

/// Drops points that fewer than `least_points` agree with, in a chain of matched points within
/// reach of each other in row and column whose disparities differ by at most one.
void drop_lonely(const PointsByRow& points,
                 const EdgeMatcherOptions& options,
                 std::vector<float>& disparity) {
  const int reach = options.agreement_reach_px;
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
          if (std::abs(disparity[static_cast<std::size_t>(q)] - disparity[k]) <= 1) {
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
    if (chains.size_of(p) >= options.least_points) continue;
    disparity[static_cast<std::size_t>(p)] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace

void check_pair(const RectifiedPair& pair, const DisparityRange& range) {
  const auto size = [](const GreyLevels& image) {
    return fmt::format("{}x{}", image.width_px, image.height_px);
  };
  if (pair.left.width_px != pair.right.width_px || pair.left.height_px != pair.right.height_px) {
    throw Error("stereo pair",
                "the left image is " + size(pair.left) + ", the right one " + size(pair.right),
                "give images of one size, rectified");
  }
  if (pair.left.width_px <= 0 || pair.left.height_px <= 0) {
    throw Error("stereo pair", "its images have no pixels", "give images");
  }
  const auto pixels =
      static_cast<std::size_t>(pair.left.width_px) * static_cast<std::size_t>(pair.left.height_px);
  if (pair.left.values.size() != pixels || pair.right.values.size() != pixels) {
    throw Error("stereo pair", "an image's values do not fill it", "give width times height");
  }
  if (range.most_px < range.least_px) {
    throw Error("disparity range", fmt::format("{} to {} is empty", range.least_px, range.most_px),
                "give the least first");
  }
  if (range.most_px >= pair.left.width_px || range.least_px <= -pair.left.width_px) {
    throw Error("disparity range",
                fmt::format("{} to {} reaches beyond the image's width of {} pixels",
                            range.least_px, range.most_px, pair.left.width_px),
                "give disparities below the width");
  }
}

std::vector<EdgeMatch> match_edges(const RectifiedPair& pair,
                                   const std::vector<EdgePoint>& left_edges,
                                   const DisparityRange& range,
                                   const EdgeMatcherOptions& options) {
  check_pair(pair, range);
  std::vector<EdgeMatch> matches(left_edges.size());
  const auto least_sine = static_cast<float>(std::sin(options.least_angle_rad));
  std::vector<int> x, y;
  std::vector<std::size_t> edge;
  for (std::size_t i = 0; i < left_edges.size(); ++i) {
    if (std::abs(left_edges[i].normal.x()) < least_sine) continue;
    x.push_back(left_edges[i].x);
    y.push_back(left_edges[i].y);
    edge.push_back(i);
  }
  if (edge.empty()) return matches;
  const PointsByRow points = points_by_row(std::move(x), std::move(y), pair.left.height_px);
  const Search search(pair, range);
  const std::vector<Winner> found = search.from_left(points);
  const std::vector<bool> confirmed = search.confirmed(points, found);
  std::vector<float> disparity(edge.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t k = 0; k < edge.size(); ++k) {
    if (!confirmed[k] || !(found[k].margin > options.least_margin)) continue;
    disparity[k] = static_cast<float>(search.least() + found[k].index) + found[k].offset;
  }
  drop_lonely(points, options, disparity);
  for (std::size_t k = 0; k < edge.size(); ++k) {
    EdgeMatch& match = matches[edge[k]];
    match.at.disparity_px = disparity[k];
    match.at.confidence = found[k].margin;
  }
  return matches;
}

Matcher edge_matcher(const EdgeMatcherOptions& options) {
  return {"edge",
          [options](const RectifiedPair& pair, const std::vector<EdgePoint>& left_edges,
                    const DisparityRange& range) {
            std::vector<EdgeDisparity> at;
            for (const EdgeMatch& match : match_edges(pair, left_edges, range, options)) {
              at.push_back(match.at);
            }
            return at;
          },
          true};
}

}  // namespace vernier
