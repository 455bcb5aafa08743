// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/edge_error.h"

#include <algorithm>
#include <cmath>

#include "stereo/canny_edges.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

bool is_scored(const EdgePoint& edge,
               const TruthAtEdge& truth,
               int width_px,
               const EvaluationOptions& options) {
  return truth.known && std::abs(edge.normal.x()) >= std::sin(options.min_angle_rad) &&
         edge.x >= options.border_px && edge.x < width_px - options.border_px;
}

bool is_occluded(const TruthAtEdge& truth, DiscontinuityRule rule) {
  return rule == DiscontinuityRule::foreground ? truth.occluded : truth.own_occluded;
}

float own_disparity_px(const EdgeDisparity& found) {
  return std::isnan(found.own_px) ? found.disparity_px : found.own_px;
}

double error_px(const EdgeDisparity& found, const TruthAtEdge& truth, DiscontinuityRule rule) {
  const double before = std::min(0.0F, truth.crossing_px),
               after = std::max(0.0F, truth.crossing_px);
  const bool outline = truth.discontinuity && rule == DiscontinuityRule::foreground;
  const double found_px = outline ? found.disparity_px : own_disparity_px(found);
  const auto error_of = [&](double surface_px) {
    const double error = found_px - surface_px;
    return error - std::clamp(error, before, after);
  };
  const double error = error_of(truth.disparity_px);
  if (rule == DiscontinuityRule::foreground || !truth.discontinuity) return error;
  double least = std::abs(error);
  for (const float surface : {truth.own_px, truth.min_px, truth.max_px}) {
    if (!std::isnan(surface)) least = std::min(least, std::abs(error_of(surface)));
  }
  return least;
}

}  // namespace vernier::stereo::internal
