// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// `stretch` on real pairs. Its limits were chosen on four of them (tests/support/scene_scores.h).
#include <gtest/gtest.h>

#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/matching/stretch_correlation.h"
#include "tests/support/data_folder.h"
#include "tests/support/foreign_files.h"
#include "tests/support/scene_files.h"
#include "tests/support/scene_scores.h"
#include "tests/support/stereo_scenes.h"

namespace vernier {

using namespace vernier::stereo::internal;

namespace {

const std::set<std::string> of_2001 = {"barn2", "bull", "tsukuba", "venus"};

TEST(StretchOnMiddlebury, DensityAndMismatch) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  const test::Folder scratch;
  test::SceneMeans early, early_held_out, chosen, others;
  for (const test::StereoScene& scene : test::middlebury_scenes(*folder)) {
    StereoSceneFile files = test::files_of(scene, scratch.path());
    const bool is_early = of_2001.count(scene.name) > 0;
    const bool is_tuned = test::tuned_scenes.count(scene.name) > 0;
    if (is_early) files.range = {-20, 20};
    const test::SceneScore score = test::score_of(stretch_matcher(), files);
    if (is_early) {
      EXPECT_GE(score.either.all.density, 0.85) << scene.name;
      EXPECT_LE(score.either.mismatch, 0.01) << scene.name;
      early.add(score);
    }
    if (is_early && !is_tuned) early_held_out.add(score);
    (is_tuned ? chosen : others).add(score);
  }
  early.record("of_2001");
  early_held_out.record("of_2001_but_barn2");
  chosen.record("tuned_on");
  others.record("others");
  EXPECT_LE(early.mismatch, 0.005);
  EXPECT_LE(early.mismatch_foreground, 0.01);
  EXPECT_GE(others.density, 0.87);
  EXPECT_LE(others.mismatch, 0.01);
}

}  // namespace
}  // namespace vernier
