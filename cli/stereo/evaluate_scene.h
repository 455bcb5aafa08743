// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cli/program/session.h"
#include "stereo/canny_edges.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::cli {

/// A stereo pair with its ground truth.
struct Scene {
  StereoSceneFile file;
  RectifiedPair pair;
  std::vector<EdgePoint> edges;
  std::vector<TruthAtEdge> truth;
  StereoTruth map;  ///< the full map
  double edges_ms = 0;
  bool out_of_range = false;  ///< the true disparities of many edges are outside the search range
};

/// The result of a matcher on a scene.
struct Run {
  MatcherScore score;
  std::vector<EdgeDisparity> found;
  double time_ms =
      0;  ///< CPU time on one thread, including edge detection if the matcher uses edges
};

/// Reads a pair and reports file conversions and vertical misalignment. Throws Error naming the
/// file.
Scene read_scene(const StereoSceneFile& file, bool wants_repair, Session& session);

/// Runs a matcher: median time of three runs, and the score.
Run run_matcher(const Matcher& matcher, const Scene& scene, const EvaluationOptions& how);

/// Throws Error if a matcher finds many more matches with left and right swapped.
void check_not_swapped(const Matcher& matcher, const Scene& scene, const Run& run);

}  // namespace vernier::cli
