// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/corner_matching.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "calib/error.h"
#include "calib/projection_uncertainty.h"
#include "calib/statistics/distributions.h"
#include "stereo/corners/corner_image.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/epipolar_band.h"
#include "stereo/corners/harris_corners.h"
#include "stereo/corners/match_support.h"
#include "stereo/image/patch_alignment.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

/// The patch at a pixel of the reduced image, sampled at `offset_px` times the offsets of a square
/// of 2 half + 1 pixels, with zero mean and unit norm.
Eigen::VectorXf patch(const CornerImage& image,
                      const Eigen::Vector2d& pixel_px,
                      const Eigen::Matrix2d& offset_px,
                      int half) {
  Eigen::VectorXf grey((2 * half + 1) * (2 * half + 1));
  Eigen::Index k = 0;
  for (int j = -half; j <= half; ++j) {
    for (int i = -half; i <= half; ++i) {
      const Eigen::Vector2d at = pixel_px + offset_px * Eigen::Vector2d(i, j);
      grey[k++] = static_cast<float>(grey_between(image.grey, at.x(), at.y()));
    }
  }
  grey.array() -= grey.mean();
  const float length = grey.norm();
  if (length > 0) grey /= length;
  return grey;
}

/// Corners by image tile.
class CornerGrid {
 public:
  explicit CornerGrid(const std::vector<ImageCorner>& corners) {
    for (const ImageCorner& corner : corners) {
      columns_ = std::max(columns_, cell(corner.pixel_px.x()) + 1);
      rows_ = std::max(rows_, cell(corner.pixel_px.y()) + 1);
    }
    cells_.resize(static_cast<std::size_t>(columns_) * rows_);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d& p = corners[i].pixel_px;
      cells_[cell(p.y()) * columns_ + cell(p.x())].push_back(static_cast<int>(i));
    }
  }

  template <class Visit>
  void for_each_within(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Visit visit) const {
    const int x0 = std::max(0, cell(low.x())), x1 = std::min(columns_ - 1, cell(high.x()));
    const int y0 = std::max(0, cell(low.y())), y1 = std::min(rows_ - 1, cell(high.y()));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        for (const int i : cells_[y * columns_ + x]) visit(i);
      }
    }
  }

 private:
  static constexpr double side_px = 16;
  static int cell(double x) { return static_cast<int>(std::floor(x / side_px)); }
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<int>> cells_;
};

struct Candidate {
  int right = 0;
  Eigen::Vector2d direction;      ///< of the epipolar curve
  Eigen::Matrix2d right_by_left;  ///< of a surface at its depth
  float score = 0;
};

/// Search structures of the right image.
struct RightSearch {
  RightSearch(const std::vector<ImageCorner>& from, double gate_probability)
      : corners(from), grid(from), nearest(from.size()) {
    for (int dof : {1, 2}) gate[dof] = chi_squared_quantile(gate_probability, dof);
    for (const ImageCorner& corner : from) {
      largest_variance = std::max(largest_variance, std::pow(worst_sd(corner.covariance_px2), 2));
    }
  }
  const std::vector<ImageCorner>& corners;
  CornerGrid grid;
  double gate[3] = {0, 0, 0};
  double largest_variance = 0;
  std::vector<BandDistance> nearest;  ///< of each corner to the current curve
};

/// Right corners within the gate of a curve, in ascending order of their indices.
std::vector<Candidate> candidates_of(const std::vector<BandNode>& curve, RightSearch& search) {
  std::vector<int> seen;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const BandNode &a = curve[i - 1], &b = curve[i];
    if (!b.follows) continue;
    const double variance = std::max(a.covariance_px2.trace(), b.covariance_px2.trace());
    const double reach = std::sqrt(search.gate[2] * (variance + search.largest_variance));
    const Eigen::Vector2d margin(reach, reach);
    search.grid.for_each_within(
        a.pixel_px.cwiseMin(b.pixel_px) - margin, a.pixel_px.cwiseMax(b.pixel_px) + margin,
        [&](int right) {
          const ImageCorner& corner = search.corners[right];
          const auto d = distance_to_step(curve, i, {corner.pixel_px, corner.covariance_px2});
          BandDistance& nearest = search.nearest[right];
          if (std::isinf(nearest.mahalanobis2)) seen.push_back(right);
          if (d.mahalanobis2 < nearest.mahalanobis2) nearest = d;
        });
  }
  std::sort(seen.begin(), seen.end());
  std::vector<Candidate> candidates;
  for (const int right : seen) {
    const BandDistance& d = search.nearest[right];
    if (d.mahalanobis2 <= search.gate[d.dof])
      candidates.push_back({right, d.direction, d.right_by_left});
    search.nearest[right] = {};
  }
  return candidates;
}

/// The unambiguous candidate, if any; `best_of_right` keeps each right corner's best score.
std::optional<Candidate> best_candidate(std::vector<Candidate>& candidates,
                                        const CornerMatchingOptions& options) {
  if (candidates.empty()) return std::nullopt;
  const auto by_score = [](const Candidate& a, const Candidate& b) { return a.score < b.score; };
  const auto best = std::max_element(candidates.begin(), candidates.end(), by_score);
  if (!(best->score >= options.min_score)) return std::nullopt;
  for (auto other = candidates.begin(); other != candidates.end(); ++other) {
    if (other != best && other->score > best->score - options.min_margin) return std::nullopt;
  }
  return *best;
}

/// ∂ right / ∂ left between the reduced images.
Eigen::Matrix2d between_reduced(const CornerImage& left,
                                const CornerImage& right,
                                const Candidate& candidate) {
  return candidate.right_by_left * (left.reduction / right.reduction);
}

/// Step 3 of match_corners().
std::optional<CornerMatch> aligned(const CornerImage& left,
                                   const CornerImage& right,
                                   std::size_t own,
                                   const Candidate& candidate,
                                   const CornerMatchingOptions& options) {
  CornerMatch match;
  match.left = static_cast<int>(own);
  match.right = candidate.right;
  match.left_px = left.corners[own].pixel_px;
  match.right_by_left = candidate.right_by_left;
  const auto alignment =
      align_patch(left.grey, right.grey, left.reduced(match.left_px),
                  right.reduced(right.corners[candidate.right].pixel_px), candidate.direction,
                  {.half_px = options.aligned_half_px,
                   .max_shift_px = options.max_shift_px,
                   .right_by_left = between_reduced(left, right, candidate),
                   .noise_left = left.noise,
                   .noise_right = right.noise});
  if (!alignment || alignment->score < options.min_aligned_score) return std::nullopt;
  match.right_px = right.raw(alignment->right_px);
  match.score = alignment->score;
  const Eigen::Vector2d normal(-candidate.direction.y(), candidate.direction.x());
  const double variance_px2 = 0.5 * normal.dot(alignment->covariance_px2 * normal) +
                              options.sigma_floor_px * options.sigma_floor_px;
  match.sigma_px =
      std::sqrt(variance_px2 * 2 /
                (1 / (left.reduction * left.reduction) + 1 / (right.reduction * right.reduction)));
  return match;
}

/// Steps 1 and 2 of match_corners(): one candidate per left corner, or none.
std::vector<std::optional<Candidate>> correlated(const CornerImage& left,
                                                 const CornerImage& right,
                                                 const EpipolarBand& band,
                                                 const CornerMatchingOptions& options,
                                                 long& count) {
  RightSearch search(right.corners, options.gate_probability);
  std::vector<std::optional<Candidate>> chosen(left.corners.size());
  std::vector<float> best_of_right(right.corners.size(), -1);
  for (std::size_t i = 0; i < left.corners.size(); ++i) {
    const ImageCorner& corner = left.corners[i];
    auto candidates = candidates_of(band.curve({corner.pixel_px, corner.covariance_px2}), search);
    count += static_cast<long>(candidates.size());
    if (candidates.empty()) continue;
    const Eigen::VectorXf own = patch(left, left.reduced(corner.pixel_px),
                                      Eigen::Matrix2d::Identity(), options.patch_half_px);
    for (Candidate& c : candidates) {
      c.score = own.dot(patch(right, right.reduced(right.corners[c.right].pixel_px),
                              between_reduced(left, right, c), options.patch_half_px));
      best_of_right[c.right] = std::max(best_of_right[c.right], c.score);
    }
    chosen[i] = best_candidate(candidates, options);
  }
  for (auto& c : chosen) {
    if (c && c->score < best_of_right[c->right]) c.reset();
  }
  return chosen;
}

void check(const CornerMatchingOptions& options) {
  if (!(options.gate_probability > 0 && options.gate_probability < 1)) {
    throw Error("matching", "gate_probability is not between 0 and 1", "use e.g. 0.997");
  }
  if (options.patch_half_px < 1 || options.aligned_half_px < 2 || options.neighbours < 1) {
    throw Error("matching", "the patch size or the number of neighbours is not positive",
                "use integers above 1");
  }
}

}  // namespace

std::vector<CornerMatch> match_corners(const CornerImage& left,
                                       const CornerImage& right,
                                       const EpipolarBand& band,
                                       const CornerMatchingOptions& options,
                                       long* candidates) {
  check(options);
  long count = 0;
  const auto chosen = correlated(left, right, band, options, count);
  if (candidates) *candidates = count;
  std::vector<CornerMatch> matches;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    if (const auto match = aligned(left, right, i, *chosen[i], options)) matches.push_back(*match);
  }
  return supported(matches, options);
}

}  // namespace vernier::stereo::internal
