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

/// Effect of row errors on a pair, before matching, over the scored edges.
struct GeometricError {
  int edges = 0;                        ///< if 0, the other fields are 0
  double bias_px = 0, bias_rms_px = 0;  ///< disparity of points minus that in the original pair
  double rows_rms_px = 0;               ///< v_left − v_right
};

/// Score of a matcher on such a pair.
struct WarpedScore {
  /// Against the warped truth (stereo/evaluation/warped_pair.h): an error here is a mismatch,
  /// independent of the geometry.
  MatcherScore score;
  /// RMS of found disparities minus those of the original pair, over smooth matches that are not
  /// mismatches: the geometric error that reaches the depth.
  double disparity_error_rms_px = 0;
  int right = 0;  ///< number of those matches
};

/// `truth` is truth_at(warped, edges).
GeometricError geometric_error(const WarpedPair& warped,
                               const std::vector<EdgePoint>& edges,
                               const std::vector<TruthAtEdge>& truth,
                               const EvaluationOptions& options = {});

/// Throws Error if edges and disparities differ in number.
WarpedScore evaluate(const WarpedPair& warped,
                     const std::vector<EdgePoint>& edges,
                     const std::vector<TruthAtEdge>& truth,
                     const std::vector<EdgeDisparity>& found,
                     const EvaluationOptions& options = {});

}  // namespace vernier::stereo::internal
