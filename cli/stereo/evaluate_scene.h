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

/// A pair with what is known of it.
struct Scene {
  StereoSceneFile file;
  RectifiedPair pair;
  std::vector<EdgePoint> edges;
  std::vector<TruthAtEdge> truth;
  StereoTruth map;  ///< the whole of it
  double edges_ms = 0;
};

/// What a matcher did on a scene.
struct Run {
  MatcherScore score;
  std::vector<EdgeDisparity> found;
  double time_ms = 0;  ///< CPU time on one thread, edges included where it works on them
};

/// Reads a pair, says what was done to its files, and what its rows differ by. Throws Error naming
/// the file.
Scene read_scene(const StereoSceneFile& file, bool wants_repair, Session& session);

/// The middle time of three runs, and the score.
Run run_matcher(const Matcher& matcher, const Scene& scene, const EvaluationOptions& how);

/// Throws Error where a matcher finds much more with left and right exchanged.
void check_not_swapped(const Matcher& matcher, const Scene& scene, const Run& run);

}  // namespace vernier::cli
