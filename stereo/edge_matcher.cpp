// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edge_matcher.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stereo/disparity_refinement.h"
#include "stereo/edge_support.h"
#include "stereo/image_noise.h"
#include "stereo/matcher_input.h"
#include "stereo/matrix_of.h"
#include "stereo/stretched_image.h"

namespace vernier {
namespace {

/// What was found for the left points.
struct Found {
  std::vector<Winner> winners;
  std::vector<bool> confirmed;  ///< found again from the right image, within a disparity
  std::vector<double> stretch;  ///< du_right / du_left
  bool slanted = false;         ///< surfaces that slant were tried
};

constexpr double slanted_slope = 0.6;  // of disparity, pixels a pixel

/// Searches points of the left image in the right one, and back.
class Search {
 public:
  Search(const RectifiedPair& pair, const DisparityRange& range)
      : pair_(pair),
        width_(pair.left.width_px),
        height_(pair.left.height_px),
        least_(range.least_px),
        searched_(range.most_px - range.least_px + 1) {
    constexpr int step = 32;
    count_ = (searched_ + step - 1) / step * step;
    border_ = count_ + std::abs(least_) + 2;
    left_ = census_transform(pair.left, border_);
    right_ = census_transform(pair.right, border_);
    mirrored_right_ = mirrored(right_);
  }

  /// Of surfaces that face the cameras or, with `slanted`, of all.
  Found find(const PointsByRow& points, bool slanted) const {
    std::vector<StretchedView> from_left, from_right;
    SupportOptions support;
    if (slanted) {
      from_left = stretched_views(mirrored(pair_.right));
      from_right = stretched_views(pair_.left);
      support.slope = slanted_slope;
      support.small_step = 10;  // what steps cost would make slopes into stairs
      support.large_step = 600;
    }
    std::vector<int> first;
    for (const int x : points.x) first.push_back(width_ - 1 - x + least_);
    CensusCosts costs{points, left_, mirrored_right_, first, Facing::opposite, count_};
    if (slanted) costs.stretched = &from_left;
    Found found{semi_global_winners(costs, Support::all, support), {}, {}, slanted};
    confirm(points, slanted ? &from_right : nullptr, support, found);
    for (int p = 0; p < points.size(); ++p) {
      const auto k = static_cast<std::size_t>(p);
      const bool ask = slanted && found.confirmed[k];
      found.stretch.push_back(ask ? 1 / best_scale(costs, p, found.winners[k].index) : 1);
    }
    return found;
  }

  int least() const { return least_; }

 private:
  std::vector<StretchedView> stretched_views(const GreyLevels& image) const {
    std::vector<StretchedView> views;
    for (const double scale : {1.3, 1.7, 2.1, 2.6, 3.2, 0.74, 0.55, 0.42}) {
      const auto border = static_cast<int>(scale * border_) + 66;
      views.push_back({scale, census_transform(stretched(image, scale), border)});
    }
    return views;
  }

  /// Searches from where the left points were found.
  void confirm(const PointsByRow& points,
               const std::vector<StretchedView>* stretched_left,
               const SupportOptions& support,
               Found& found) const {
    std::vector<int> place(points.x.size(), -1), index(static_cast<std::size_t>(width_));
    std::vector<int> x, y, first;
    std::vector<int> there(points.x.size(), -1);
    for (std::size_t row = 0; row + 1 < points.row_begin.size(); ++row) {
      std::fill(index.begin(), index.end(), -1);
      for (int p = points.row_begin[row]; p < points.row_begin[row + 1]; ++p) {
        const auto k = static_cast<std::size_t>(p);
        const int at = points.x[k] - least_ - found.winners[k].index;
        if (at < 0 || at >= width_ || found.winners[k].index >= searched_) continue;
        place[k] = at;
        index[static_cast<std::size_t>(at)] = 0;
      }
      for (int at = 0; at < width_; ++at) {
        if (index[static_cast<std::size_t>(at)] < 0) continue;
        index[static_cast<std::size_t>(at)] = static_cast<int>(x.size());
        x.push_back(at);
        y.push_back(static_cast<int>(row));
        first.push_back(at + least_);
      }
      for (int p = points.row_begin[row]; p < points.row_begin[row + 1]; ++p) {
        const auto k = static_cast<std::size_t>(p);
        if (place[k] >= 0) there[k] = index[static_cast<std::size_t>(place[k])];
      }
    }
    const PointsByRow right = points_by_row(std::move(x), std::move(y), height_);
    CensusCosts costs{right, right_, left_, first, Facing::same, count_};
    costs.stretched = stretched_left;
    const std::vector<Winner> back =
        semi_global_winners(costs, stretched_left ? Support::all : Support::from_above, support);
    for (std::size_t k = 0; k < there.size(); ++k) {
      const int tolerance = stretched_left ? 2 : 1;
      found.confirmed.push_back(there[k] >= 0 &&
                                std::abs(back[static_cast<std::size_t>(there[k])].index -
                                         found.winners[k].index) <= tolerance);
    }
  }

  const RectifiedPair& pair_;
  int width_, height_, least_, searched_, count_ = 0, border_ = 0;
  CensusImage left_, right_, mirrored_right_;
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
/// reach of each other in row and column whose disparities differ by at most one, and by `slope`
/// for every column between them.
void drop_lonely(const PointsByRow& points,
                 const EdgeMatcherOptions& options,
                 double slope,
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
    if (chains.size_of(p) >= options.least_points) continue;
    disparity[static_cast<std::size_t>(p)] = std::numeric_limits<float>::quiet_NaN();
  }
}

/// Disparities that pass all tests, not a number for the others.
std::vector<float> accepted(const PointsByRow& points,
                            const Search& search,
                            const Found& found,
                            const EdgeMatcherOptions& options) {
  std::vector<float> disparity(points.x.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t k = 0; k < disparity.size(); ++k) {
    const Winner& best = found.winners[k];
    if (!found.confirmed[k] || !(best.margin > options.least_margin)) continue;
    disparity[k] = static_cast<float>(search.least() + best.index) + best.offset;
  }
  drop_lonely(points, options, found.slanted ? slanted_slope : 0, disparity);
  return disparity;
}

/// Least squares at points: at first where disparities were found, then from neighbours that are
/// settled already, whose surface says where to start.
class Refinement {
 public:
  Refinement(const RectifiedPair& pair,
             const PointsByRow& points,
             bool slanted,
             const EdgeMatcherOptions& options)
      : pair_(pair),
        points_(points),
        least_score_(slanted ? options.least_slanted_score : options.least_score),
        fits_(points.x.size()) {
    how_.most_shift_px = slanted ? 1.0f : 0.7f;  // support is right to half a disparity, mostly
    how_.noise_left = static_cast<float>(image_noise(matrix_of(pair.left)));
    how_.noise_right = static_cast<float>(image_noise(matrix_of(pair.right)));
  }

  void from(const std::vector<float>& disparity, const std::vector<double>& stretch) {
    std::vector<RefinementStart> starts;
    std::vector<int> at;
    for (int p = 0; p < points_.size(); ++p) {
      const auto k = static_cast<std::size_t>(p);
      if (std::isnan(disparity[k])) continue;
      starts.push_back({points_.x[k], points_.y[k], disparity[k], static_cast<float>(stretch[k])});
      at.push_back(p);
    }
    take(starts, at);
  }

  /// One sweep over the points that are not settled; returns how many were won.
  int grow() {
    std::vector<RefinementStart> starts;
    std::vector<int> at;
    for (int p = 0; p < points_.size(); ++p) {
      if (settled(p)) continue;
      std::vector<float> tried;
      for (const int q : points_.neighbours[static_cast<std::size_t>(p)]) {
        constexpr double reach_px = 12;
        if (q < 0 || !settled(q) || points_.distance_px(p, q) > reach_px) continue;
        const RefinementStart start = seen_from(q, p);
        constexpr float same_px = 0.3f;
        const bool again = std::any_of(tried.begin(), tried.end(), [&](float d) {
          return std::abs(d - start.disparity_px) < same_px;
        });
        if (again) continue;
        tried.push_back(start.disparity_px);
        starts.push_back(start);
        at.push_back(p);
      }
    }
    return take(starts, at);
  }

  /// Unsettles points whose surface most of their settled neighbours contradict by over a pixel.
  void drop_contradicted() {
    std::vector<int> dropped;
    for (int p = 0; p < points_.size(); ++p) {
      if (!settled(p)) continue;
      int agree = 0, contradict = 0;
      for (const int q : points_.neighbours[static_cast<std::size_t>(p)]) {
        if (q < 0 || !settled(q)) continue;
        const float off =
            seen_from(q, p).disparity_px - fits_[static_cast<std::size_t>(p)].disparity_px;
        (std::abs(off) <= 1 ? agree : contradict)++;
      }
      if (contradict > agree) dropped.push_back(p);
    }
    for (const int p : dropped) fits_[static_cast<std::size_t>(p)].settled = false;
  }

  bool settled(int p) const { return fits_[static_cast<std::size_t>(p)].settled; }
  const RefinedDisparity& fit(int p) const { return fits_[static_cast<std::size_t>(p)]; }

 private:
  /// Where point p would be on the surface found at q.
  RefinementStart seen_from(int q, int p) const {
    const auto a = static_cast<std::size_t>(q), b = static_cast<std::size_t>(p);
    const RefinedDisparity& fit = fits_[a];
    const auto dx = static_cast<float>(points_.x[b] - points_.x[a]);
    const auto dy = static_cast<float>(points_.y[b] - points_.y[a]);
    return {points_.x[b], points_.y[b], fit.disparity_px + (1 - fit.stretch) * dx - fit.shear * dy,
            fit.stretch, fit.shear};
  }

  /// Keeps the fits that correlate better than what a point has.
  int take(const std::vector<RefinementStart>& starts, const std::vector<int>& at) {
    const std::vector<RefinedDisparity> found =
        refine_disparities(pair_.left, pair_.right, starts, how_);
    int won = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      RefinedDisparity& best = fits_[static_cast<std::size_t>(at[i])];
      if (!found[i].settled || !(found[i].score > least_score_)) continue;
      if (best.settled && best.score >= found[i].score) continue;
      won += !best.settled;
      best = found[i];
    }
    return won;
  }

  const RectifiedPair& pair_;
  const PointsByRow& points_;
  double least_score_;
  RefinementOptions how_;
  std::vector<RefinedDisparity> fits_;
};

}  // namespace

std::vector<EdgeMatch> match_edges(const RectifiedPair& pair,
                                   const std::vector<EdgePoint>& left_edges,
                                   const DisparityRange& range,
                                   const EdgeMatcherOptions& options) {
  check_matcher_input(pair, range, "edge");
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
  Found found = search.find(points, false);
  std::vector<float> disparity = accepted(points, search, found, options);
  if (options.slanted_above < 1) {
    const auto matched = static_cast<double>(
        std::count_if(disparity.begin(), disparity.end(), [](float d) { return !std::isnan(d); }));
    if (1 - matched / points.size() > options.slanted_above) {
      found = search.find(points, true);
      disparity = accepted(points, search, found, options);
    }
  }
  Refinement refinement(pair, points, found.slanted, options);
  if (options.refine) {
    refinement.from(disparity, found.stretch);
    if (found.slanted) {
      constexpr int sweeps = 20;
      for (int sweep = 0; sweep < sweeps; ++sweep) {
        refinement.drop_contradicted();
        if (refinement.grow() == 0) break;
      }
      refinement.drop_contradicted();
      std::fill(disparity.begin(), disparity.end(), std::numeric_limits<float>::quiet_NaN());
    }
  }
  for (std::size_t k = 0; k < edge.size(); ++k) {
    EdgeMatch& match = matches[edge[k]];
    match.at.disparity_px = disparity[k];
    match.at.confidence = found.winners[k].margin;
    if (!options.refine) continue;
    match.refined = refinement.settled(static_cast<int>(k));
    if (!std::isnan(disparity[k])) {
      match.at.sigma_px = static_cast<float>(options.unrefined_sigma_px);
    }
    if (!match.refined) continue;
    const RefinedDisparity& fit = refinement.fit(static_cast<int>(k));
    const float off_centre = left_edges[edge[k]].row_x_px - static_cast<float>(points.x[k]);
    match.at.disparity_px = fit.disparity_px + (1 - fit.stretch) * off_centre;
    match.at.sigma_px = std::hypot(fit.sigma_px, static_cast<float>(options.sigma_floor_px));
    match.stretch = fit.stretch;
    match.shear = fit.shear;
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
