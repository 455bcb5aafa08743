// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/warped_evaluation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stereo/canny_edges.h"
#include "stereo/evaluation/edge_error.h"
#include "stereo/evaluation/warped_pair.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {
namespace {

constexpr double max_error_px = 3;

}  // namespace

GeometricError geometric_error(const WarpedPair& warped,
                               const std::vector<EdgePoint>& edges,
                               const std::vector<TruthAtEdge>& truth,
                               const EvaluationOptions& options) {
  double sum = 0, squares = 0, rows = 0;
  int count = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!is_scored(edges[i], truth[i], warped.pair.left.width_px, options)) continue;
    const double bias = warped.bias_px(edges[i].x, edges[i].y);
    const double dy = warped.vertical_px(edges[i].x, edges[i].y);
    if (!std::isfinite(bias + dy)) continue;
    sum += bias;
    squares += bias * bias;
    rows += dy * dy;
    ++count;
  }
  const double n = std::max(1, count);
  return {count, sum / n, std::sqrt(squares / n), std::sqrt(rows / n)};
}

WarpedScore evaluate(const WarpedPair& warped,
                     const std::vector<EdgePoint>& edges,
                     const std::vector<TruthAtEdge>& truth,
                     const std::vector<EdgeDisparity>& found,
                     const EvaluationOptions& options) {
  const int width = warped.pair.left.width_px;
  WarpedScore result{evaluate(edges, found, truth, width, options), 0, 0};
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const TruthAtEdge& at = truth[i];
    if (!found[i].matched() || at.discontinuity || !is_scored(edges[i], at, width, options))
      continue;
    if (is_occluded(at, options.outline) ||
        std::abs(error_px(found[i], at, options.outline)) > max_error_px) {
      continue;
    }
    const double bias = warped.bias_px(edges[i].x, edges[i].y);
    if (!std::isfinite(bias)) continue;
    const double error = own_disparity_px(found[i]) - (at.own_px - bias);
    squares += error * error;
    ++count;
  }
  result.disparity_error_rms_px = std::sqrt(squares / std::max(1, count));
  result.right = count;
  return result;
}

}  // namespace vernier::stereo::internal
