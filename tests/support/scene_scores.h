// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "stereo/canny_edges.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::test {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

/// The scenes of the eleven on which limits of matchers were chosen.
inline const std::set<std::string> tuned_scenes = {"barn2", "teddy", "Art", "motorcycle"};

/// One run of a matcher, scored by both rules at a step of the truth.
struct SceneScore {
  MatcherScore either, foreground;
};

inline SceneScore score_of(const Matcher& matcher, const StereoSceneFile& files) {
  const RectifiedPair pair{read_grey_levels(files.left), read_grey_levels(files.right)};
  const int width = pair.left.width_px;
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const auto truth = truth_at(read_stereo_truth(files, width, pair.left.height_px), edges);
  const auto found = matcher.match(pair, edges, files.range);
  return {evaluate(edges, found, truth, width),
          evaluate(edges, found, truth, width, {.outline = DiscontinuityRule::foreground})};
}

/// Means over scenes.
struct SceneMeans {
  double density = 0, bad_1 = 0, mismatch = 0, coverage_95 = 0;
  double bad_1_foreground = 0, mismatch_foreground = 0;
  int scenes = 0;

  void add(const SceneScore& s) {
    const double n = ++scenes;
    const auto mean = [&](double& of, double value) { of += (value - of) / n; };
    mean(density, s.either.all.density);
    mean(bad_1, s.either.all.bad_1);
    mean(mismatch, s.either.mismatch);
    mean(coverage_95, s.either.coverage_95);
    mean(bad_1_foreground, s.foreground.all.bad_1);
    mean(mismatch_foreground, s.foreground.mismatch);
  }

  /// As properties of the running test.
  void record(const std::string& name) const {
    const auto set = [&](const char* what, double value) {
      testing::Test::RecordProperty(name + "_" + what, std::to_string(value));
    };
    set("density", density);
    set("bad_1", bad_1);
    set("mismatch", mismatch);
    set("coverage_95", coverage_95);
    set("bad_1_foreground", bad_1_foreground);
    set("mismatch_foreground", mismatch_foreground);
  }
};

}  // namespace vernier::test
