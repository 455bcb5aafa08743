// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "stereo/edges/edge_points_by_row.h"
#include "stereo/grey_levels.h"
#include "stereo/image/image_noise.h"
#include "stereo/image/matrix_of.h"
#include "stereo/matching/disparity_refinement.h"

namespace vernier::stereo::internal {

/// Least squares refinement of edge points: first where disparities were found, then at neighbours
/// of refined points, starting from their surface.
class EdgeRefinement {
 public:
  EdgeRefinement(const RectifiedPair& pair,
                 const PointsByRow& points,
                 const DisparityRange& range,
                 bool slanted,
                 double min_score)
      : points_(points),
        range_(range),
        min_score_(min_score),
        refiner_(pair.left, pair.right, options_of(pair, slanted)),
        fits_(points.x.size()) {}

  /// Starts from given disparities; NaN: none.
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

  /// Fraction of the refined points with a disparity gradient above 0.2 px per pixel.
  double slanted_share() const {
    constexpr float slant = 0.2f;
    int settled = 0, slanted = 0;
    for (const RefinedDisparity& fit : fits_) {
      settled += fit.settled;
      slanted += fit.settled && std::hypot(fit.stretch - 1, fit.shear) > slant;
    }
    return static_cast<double>(slanted) / std::max(1, settled);
  }

  /// One sweep over the points that are not refined yet, except those `spared`; returns the number
  /// gained.
  int grow(const std::vector<bool>& spared) {
    std::vector<RefinementStart> starts;
    std::vector<int> at;
    for (int p = 0; p < points_.size(); ++p) {
      if (settled(p) || spared[static_cast<std::size_t>(p)]) continue;
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

  /// Discards points whose surface most of their refined neighbours contradict by over a pixel.
  void remove_inconsistent() {
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
  static RefinementOptions options_of(const RectifiedPair& pair, bool slanted) {
    RefinementOptions how;
    how.max_shift_px =
        slanted ? 1.0f : 0.7f;  // the support's disparity is mostly within half a pixel
    const bool resampled = pair.left_noise.levels > 0;
    const double seen = image_noise(matrix_of(pair.left)),
                 levels = resampled ? pair.left_noise.levels : seen;
    how.noise_left = static_cast<float>(resampled ? pair.left_noise.per_pixel() : seen);
    how.noise_right =
        static_cast<float>(pair.right_noise.levels > 0 ? pair.right_noise.per_pixel()
                                                       : image_noise(matrix_of(pair.right)));
    // Half of white noise's; of an image that was resampled by cubic convolution 0.35 of that
    // before, of which its single pixels show a third.
    how.slope_variance = static_cast<float>((seen * seen + levels * levels) / 4);
    return how;
  }

  /// Predicted start at point p on the surface found at q.
  RefinementStart seen_from(int q, int p) const {
    const auto a = static_cast<std::size_t>(q), b = static_cast<std::size_t>(p);
    const RefinedDisparity& fit = fits_[a];
    const auto dx = static_cast<float>(points_.x[b] - points_.x[a]);
    const auto dy = static_cast<float>(points_.y[b] - points_.y[a]);
    return {points_.x[b], points_.y[b], fit.disparity_px + (1 - fit.stretch) * dx - fit.shear * dy,
            fit.stretch, fit.shear};
  }

  /// Keeps the fits with a better correlation than the current one of the point.
  int take(const std::vector<RefinementStart>& starts, const std::vector<int>& at) {
    const std::vector<RefinedDisparity> found = refiner_.refine(starts);
    int won = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      RefinedDisparity& best = fits_[static_cast<std::size_t>(at[i])];
      if (!found[i].settled || !(found[i].score > min_score_)) continue;
      const float d = found[i].disparity_px;
      if (d < static_cast<float>(range_.min_px) - 1 || d > static_cast<float>(range_.max_px) + 1) {
        continue;
      }
      if (best.settled && best.score >= found[i].score) continue;
      won += !best.settled;
      best = found[i];
    }
    return won;
  }

  const PointsByRow& points_;
  DisparityRange range_;
  double min_score_;
  DisparityRefiner refiner_;
  std::vector<RefinedDisparity> fits_;
};

}  // namespace vernier::stereo::internal
