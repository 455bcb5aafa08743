// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/canny_edges.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// Whether an edge is one of those that are asked about: its truth is known, it is not too near to
/// the row nor to the border.
bool is_scored(const EdgePoint& edge,
               const TruthAtEdge& truth,
               int width_px,
               const EvaluationOptions& options);

/// Whether the right image does not show an edge, by the rule.
bool is_occluded(const TruthAtEdge& truth, DiscontinuityRule rule);

/// Found less true disparity; at a step of the truth by the rule `either` its size, to the nearest
/// that counts. 0 between the point's and its crossing's (TruthAtEdge::crossing_px).
double error_px(const EdgeDisparity& found, const TruthAtEdge& truth, DiscontinuityRule rule);

}  // namespace vernier::stereo::internal
