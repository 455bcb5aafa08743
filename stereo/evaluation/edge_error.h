// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/canny_edges.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// Whether an edge is scored: its ground truth is known, and it is neither too close to horizontal
/// nor to the border.
bool is_scored(const EdgePoint& edge,
               const TruthAtEdge& truth,
               int width_px,
               const EvaluationOptions& options);

/// Whether an edge is not visible in the right image, by the rule.
bool is_occluded(const TruthAtEdge& truth, DiscontinuityRule rule);

/// The disparity of the edge's own pixel, whatever surface is around it.
float own_disparity_px(const EdgeDisparity& found);

/// Found minus true disparity; at a discontinuity of the truth under rule `either`, the absolute
/// difference to the nearest valid disparity. 0 between the point's disparity and that of its
/// crossing (TruthAtEdge::crossing_px). A dense map counts by the edge's own pixel, under rule
/// `foreground` at a discontinuity of the truth by the foreground around it: a discontinuity that
/// the map alone has is an error of the map, which must neither hide nor spread.
double error_px(const EdgeDisparity& found, const TruthAtEdge& truth, DiscontinuityRule rule);

}  // namespace vernier::stereo::internal
