// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/evaluation/warped_pair.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// What wrong rows do to a pair before any matcher sees it, over the edges that are asked about.
struct GeometricError {
  int edges = 0;                        ///< of none the rest is 0
  double bias_px = 0, bias_rms_px = 0;  ///< disparities of points, less those of the pair as given
  double rows_rms_px = 0;               ///< v_left − v_right
};

/// How a matcher did on such a pair.
struct WarpedScore {
  /// Against the warped truth (stereo/evaluation/warped_pair.h): what is wrong here was matched to
  /// something else, whatever the geometry.
  MatcherScore score;
  /// Root mean square of found disparities less those of the pair as given, of smooth matches that
  /// are no mismatch: the geometric error as it reaches the depth.
  double disparity_error_rms_px = 0;
  int right = 0;  ///< how many those are
};

/// `truth` is truth_at(warped, edges).
GeometricError geometric_error(const WarpedPair& warped,
                               const std::vector<EdgePoint>& edges,
                               const std::vector<TruthAtEdge>& truth,
                               const EvaluationOptions& options = {});

/// Throws Error where edges and disparities are not of one number.
WarpedScore evaluate(const WarpedPair& warped,
                     const std::vector<EdgePoint>& edges,
                     const std::vector<TruthAtEdge>& truth,
                     const std::vector<EdgeDisparity>& found,
                     const EvaluationOptions& options = {});

}  // namespace vernier::stereo::internal
