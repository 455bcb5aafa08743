// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edge_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "calib/error.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_points_by_row.h"
#include "stereo/grey_levels.h"
#include "stereo/image/stretched_image.h"
#include "stereo/matcher.h"
#include "stereo/matching/census.h"
#include "stereo/matching/disparity_refinement.h"
#include "stereo/matching/edge_agreement.h"
#include "stereo/matching/edge_refinement.h"
#include "stereo/matching/edge_support.h"
#include "stereo/matching/matcher_input.h"
#include "stereo/matching/side_levels.h"
#include "stereo/matching/tone_curve.h"

namespace vernier::stereo {

using namespace internal;

namespace {

/// Result of a search for the left points.
struct Found {
  std::vector<Winner> winners;
  std::vector<bool> confirmed;  ///< matched back from the right image, within one disparity
  std::vector<double> stretch;  ///< du_right / du_left
  bool slanted = false;         ///< slanted surfaces were searched
};

constexpr double slanted_slope = 0.6;  // of disparity, pixels per pixel

/// Matches points of the left image to the right one, and back.
class EdgeSearch {
 public:
  /// `points` and the offsets of their sides outlive the search.
  EdgeSearch(const RectifiedPair& pair,
             const PointsByRow& points,
             const std::vector<SideOffset>& sides,
             const DisparityRange& range,
             bool compare_levels)
      : pair_(pair),
        points_(points),
        offsets_(sides),
        width_(pair.left.width_px),
        height_(pair.left.height_px),
        least_(range.min_px),
        searched_(range.max_px - range.min_px + 1) {
    constexpr int step = 32;
    count_ = (searched_ + step - 1) / step * step;
    border_ = count_ + std::abs(least_) + 2 + side_border;
    left_ = census_transform(pair.left, border_);
    right_ = census_transform(pair.right, border_);
    mirrored_right_ = mirrored(right_);
    for (const int x : points.x) first_.push_back(width_ - 1 - x + least_);
    if (!compare_levels) return;
    left_levels_ = mean_levels(pair.left, border_);
    const LevelImage right = mean_levels(pair.right, border_);
    const LevelImage mirrored_right = mirrored(right);
    tones_ =
        tones_of(level_pairs({points, left_, mirrored_right_, first_, Facing::opposite, count_},
                             {left_levels_, mirrored_right, sides}, searched_));
    if (!tones_) return;
    right_levels_ = toned(right, tones_->curve);
    mirrored_right_levels_ = toned(mirrored_right, tones_->curve);
  }

  /// For fronto-parallel surfaces or, with `slanted`, all.
  Found find(bool slanted) const {
    std::vector<StretchedView> from_left, from_right;
    SupportOptions support;
    if (slanted) {
      from_left = stretched_views(mirrored(pair_.right), Facing::opposite);
      support.slope = slanted_slope;
      support.small_step = 10;  // otherwise step penalties would turn slopes into stairs
      support.large_step = 600;
    }
    const SideLevels sides{left_levels_, mirrored_right_levels_, offsets_, tolerance()};
    CensusCosts costs{points_, left_, mirrored_right_, first_, Facing::opposite, count_};
    if (tones_) costs.sides = &sides;
    if (slanted) costs.stretched = &from_left;
    Found found{semi_global_disparities(costs, Support::all, support), {}, {}, slanted};
    for (int p = 0; p < points_.size(); ++p) {
      const int index = found.winners[static_cast<std::size_t>(p)].index;
      found.stretch.push_back(slanted ? 1 / best_scale(costs, p, index) : 1);
    }
    from_left.clear();
    if (slanted) from_right = stretched_views(pair_.left, Facing::same);
    confirm(slanted ? &from_right : nullptr, support, found);
    return found;
  }

  int least() const { return least_; }

 private:
  /// Census words refer to the images' own pixel order, so a mirrored image is mirrored back.
  std::vector<StretchedView> stretched_views(const GreyLevels& image, Facing facing) const {
    const bool is_left = facing == Facing::same;  // in its own tones
    std::vector<StretchedView> views;
    for (const double scale : {1.3, 1.7, 2.1, 2.6, 3.2, 0.74, 0.55, 0.42}) {
      const auto border = static_cast<int>(scale * border_) + 66 + side_border;
      const GreyLevels wide = stretched(image, scale);
      const LevelImage levels = tones_ ? mean_levels(wide, border) : LevelImage{};
      views.push_back({scale,
                       is_left ? census_transform(wide, border)
                               : mirrored(census_transform(mirrored(wide), border)),
                       is_left || !tones_ ? levels : toned(levels, tones_->curve)});
    }
    return views;
  }

  int tolerance() const { return tones_ ? tones_->tolerance : 0; }

  /// Searches from the matched positions of the left points.
  void confirm(const std::vector<StretchedView>* stretched_left,
               const SupportOptions& support,
               Found& found) const {
    const PointsByRow& points = points_;
    std::vector<int> place(points.x.size(), -1), index(static_cast<std::size_t>(width_));
    std::vector<int> x, y, first;
    std::vector<SideOffset> offsets;  // of the last of the points that match there
    std::vector<int> there(points.x.size(), -1);
    for (std::size_t row = 0; row + 1 < points.row_begin.size(); ++row) {
      std::fill(index.begin(), index.end(), -1);
      for (int p = points.row_begin[row]; p < points.row_begin[row + 1]; ++p) {
        const auto k = static_cast<std::size_t>(p);
        const int at = points.x[k] - least_ - found.winners[k].index;
        if (at < 0 || at >= width_ || found.winners[k].index >= searched_) continue;
        place[k] = at;
        index[static_cast<std::size_t>(at)] = p;
      }
      for (int at = 0; at < width_; ++at) {
        int& matched = index[static_cast<std::size_t>(at)];
        if (matched < 0) continue;
        offsets.push_back(offsets_[static_cast<std::size_t>(matched)]);
        matched = static_cast<int>(x.size());
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
    const SideLevels sides{right_levels_, left_levels_, offsets, tolerance()};
    CensusCosts costs{right, right_, left_, first, Facing::same, count_};
    if (tones_) costs.sides = &sides;
    costs.stretched = stretched_left;
    const std::vector<Winner> back = semi_global_disparities(
        costs, stretched_left ? Support::all : Support::from_above, support);
    for (std::size_t k = 0; k < there.size(); ++k) {
      const int tolerance = stretched_left ? 2 : 1;
      found.confirmed.push_back(there[k] >= 0 &&
                                std::abs(back[static_cast<std::size_t>(there[k])].index -
                                         found.winners[k].index) <= tolerance);
    }
  }

  const RectifiedPair& pair_;
  const PointsByRow& points_;
  const std::vector<SideOffset>& offsets_;
  int width_, height_, least_, searched_, count_ = 0, border_ = 0;
  std::vector<int> first_;  ///< place of every left point in the mirrored right image
  CensusImage left_, right_, mirrored_right_;
  /// From the right image to the left one, in which all levels are; none: levels are not compared.
  std::optional<Tones> tones_;
  LevelImage left_levels_, right_levels_, mirrored_right_levels_;
};

/// Disparities that pass all tests, NaN for the others.
std::vector<float> accepted(const PointsByRow& points,
                            const EdgeSearch& search,
                            const Found& found,
                            const EdgeMatcherOptions& options) {
  std::vector<float> disparity(points.x.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t k = 0; k < disparity.size(); ++k) {
    const Winner& best = found.winners[k];
    if (!found.confirmed[k] || !(best.margin > options.min_margin)) continue;
    disparity[k] = static_cast<float>(search.least() + best.index) + best.offset;
  }
  remove_isolated(points, options.min_points, options.agreement_reach_px,
                  found.slanted ? slanted_slope : 0, disparity);
  return disparity;
}

/// Result of a search and its valid part.
struct Attempt {
  Found found;
  std::vector<float> disparity;  ///< of points that pass all tests
  std::vector<bool> confirmed;   ///< those points
  std::optional<EdgeRefinement> refinement;
};

double unmatched_share(const std::vector<float>& disparity) {
  const auto unmatched =
      std::count_if(disparity.begin(), disparity.end(), [](float d) { return std::isnan(d); });
  return static_cast<double>(unmatched) / static_cast<double>(disparity.size());
}

/// For fronto-parallel surfaces; for all, if too many points stay unmatched or too many matched
/// ones slant.
Attempt attempt_at(const RectifiedPair& pair,
                   const PointsByRow& points,
                   const std::vector<SideOffset>& sides,
                   const DisparityRange& range,
                   const EdgeMatcherOptions& options) {
  const EdgeSearch search(pair, points, sides, range, options.compare_levels);
  Attempt attempt;
  for (bool slanted = false;; slanted = true) {
    attempt.found = search.find(slanted);
    attempt.disparity = accepted(points, search, attempt.found, options);
    if (!slanted && unmatched_share(attempt.disparity) > options.slanted_above) continue;
    if (!options.refine) break;
    attempt.refinement.emplace(pair, points, range, slanted,
                               slanted ? options.min_slanted_score : options.min_score);
    attempt.refinement->from(attempt.disparity, attempt.found.stretch);
    if (slanted || attempt.refinement->slanted_share() <= options.slanted_above) break;
  }
  for (const float d : attempt.disparity) attempt.confirmed.push_back(!std::isnan(d));
  return attempt;
}

/// Least squares starting from neighbours' surfaces: at unmatched points and, if there are slanted
/// surfaces, at all points not refined yet, because the support is not accurate to a pixel there.
void grow(Attempt& attempt) {
  EdgeRefinement& refinement = *attempt.refinement;
  if (!attempt.found.slanted) {
    constexpr int sweeps = 4;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      if (refinement.grow(attempt.confirmed) == 0) break;
    }
    return;
  }
  constexpr int sweeps = 20;
  const std::vector<bool> none(attempt.confirmed.size(), false);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    refinement.remove_inconsistent();
    if (refinement.grow(none) == 0) break;
  }
  refinement.remove_inconsistent();
  std::fill(attempt.disparity.begin(), attempt.disparity.end(),
            std::numeric_limits<float>::quiet_NaN());
}

/// Throws Error unless the edges are points of the image in the order of (y, x).
void check_edges(const std::vector<EdgePoint>& edges, const GreyLevels& image) {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const EdgePoint& e = edges[i];
    const bool inside = e.x >= 0 && e.y >= 0 && e.x < image.width_px && e.y < image.height_px;
    const bool in_order =
        i == 0 || edges[i - 1].y < e.y || (edges[i - 1].y == e.y && edges[i - 1].x < e.x);
    if (inside && in_order) continue;
    throw Error("edge",
                inside ? "the edge points are not sorted by row and column"
                       : "an edge point is outside the left image",
                "use the points of canny_edges");
  }
}

}  // namespace

std::vector<EdgeMatch> match_edges(const RectifiedPair& pair,
                                   const std::vector<EdgePoint>& left_edges,
                                   const DisparityRange& range,
                                   const EdgeMatcherOptions& options) {
  check_matcher_input(pair, range, "edge");
  check_edges(left_edges, pair.left);
  std::vector<EdgeMatch> matches(left_edges.size());
  const auto min_sine = static_cast<float>(std::sin(options.min_angle_rad));
  std::vector<int> x, y;
  std::vector<std::size_t> edge;
  std::vector<SideOffset> sides;
  for (std::size_t i = 0; i < left_edges.size(); ++i) {
    if (std::abs(left_edges[i].normal.x()) < min_sine) continue;
    x.push_back(left_edges[i].x);
    y.push_back(left_edges[i].y);
    edge.push_back(i);
    sides.push_back(side_offset(left_edges[i].normal));
  }
  if (edge.empty()) return matches;
  const PointsByRow points = points_by_row(std::move(x), std::move(y), pair.left.height_px);
  Attempt attempt = attempt_at(pair, points, sides, range, options);
  if (attempt.refinement) grow(attempt);
  for (std::size_t k = 0; k < edge.size(); ++k) {
    EdgeMatch& match = matches[edge[k]];
    const bool accepted = !std::isnan(attempt.disparity[k]);
    match.at.disparity_px = attempt.disparity[k];
    match.at.confidence = attempt.found.winners[k].margin;
    if (!attempt.refinement) continue;
    match.refined = attempt.refinement->settled(static_cast<int>(k));
    if (accepted) match.at.sigma_px = static_cast<float>(options.unrefined_sigma_px);
    if (!match.refined) continue;
    const RefinedDisparity& fit = attempt.refinement->fit(static_cast<int>(k));
    if (!attempt.confirmed[k])
      match.at.confidence = fit.score - 1;  // less confident than any confirmed match
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

}  // namespace vernier::stereo
