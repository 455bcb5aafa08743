// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// `stretch` on real pairs. Its limits were chosen on four of them, named here.
#include <gtest/gtest.h>

#include <set>

#include "stereo/canny_edges.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stretch_correlation.h"
#include "tests/support/data_folder.h"
#include "tests/support/foreign_files.h"
#include "tests/support/scene_files.h"

namespace vernier {
namespace {

const std::set<std::string> tuned = {"barn2", "teddy", "Art", "motorcycle"};
const std::set<std::string> of_2001 = {"barn2", "bull", "tsukuba", "venus"};

struct Means {
  double density = 0, bad_1 = 0, mismatch = 0, strict_mismatch = 0;
  int scenes = 0;

  void add(const MatcherScore& either, const MatcherScore& strict) {
    density += either.all.density;
    bad_1 += either.all.bad_1;
    mismatch += either.mismatch;
    strict_mismatch += strict.mismatch;
    ++scenes;
  }
  void record(const std::string& name) const {
    const auto set = [&](const char* what, double sum) {
      testing::Test::RecordProperty(name + "_" + what, std::to_string(sum / scenes));
    };
    set("density", density);
    set("bad_1", bad_1);
    set("mismatch", mismatch);
    set("mismatch_foreground", strict_mismatch);
  }
};

TEST(StretchOnMiddlebury, DensityAndMismatch) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  const test::Folder scratch;
  Means early, early_held_out, chosen, others;
  for (const test::StereoScene& scene : test::middlebury_scenes(*folder)) {
    StereoSceneFile files = test::files_of(scene, scratch.path());
    const bool is_early = of_2001.count(scene.name) > 0, is_tuned = tuned.count(scene.name) > 0;
    if (is_early) files.range = {-20, 20};
    const RectifiedPair pair{read_grey_levels(files.left), read_grey_levels(files.right)};
    const int width = pair.left.width_px;
    const std::vector<EdgePoint> edges = canny_edges(pair.left);
    const auto truth = truth_at(read_stereo_truth(files, width, pair.left.height_px), edges);
    const auto found = stretch_matcher().match(pair, edges, files.range);
    EvaluationOptions how;
    const MatcherScore either = evaluate(edges, found, truth, width, how);
    how.outline = OutlineRule::foreground;
    const MatcherScore strict = evaluate(edges, found, truth, width, how);
    if (is_early) {
      EXPECT_GE(either.all.density, 0.85) << scene.name;
      EXPECT_LE(either.mismatch, 0.01) << scene.name;
      early.add(either, strict);
    }
    if (is_early && !is_tuned) early_held_out.add(either, strict);
    (is_tuned ? chosen : others).add(either, strict);
  }
  early.record("of_2001");
  early_held_out.record("of_2001_but_barn2");
  chosen.record("tuned_on");
  others.record("others");
  EXPECT_LE(early.mismatch / early.scenes, 0.005);
  EXPECT_LE(early.strict_mismatch / early.scenes, 0.01);
  EXPECT_GE(others.density / others.scenes, 0.87);
  EXPECT_LE(others.mismatch / others.scenes, 0.01);
}

}  // namespace
}  // namespace vernier
