// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's matchers at the edges of the eleven Middlebury pairs: the defaults were chosen on these.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "stereo/canny_edges.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/dense_matchers.h"
#include "stereo/matching/edge_sampling.h"
#include "stereo/stereo_truth.h"
#include "tests/support/data_folder.h"
#include "tests/support/foreign_files.h"
#include "tests/support/scene_files.h"
#include "tests/support/stereo_scenes.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

struct DenseScene {
  RectifiedPair pair;
  std::vector<EdgePoint> edges;
  std::vector<TruthAtEdge> truth;
  DisparityRange range;
};

std::vector<DenseScene> scenes_of(const std::filesystem::path& folder) {
  const test::Folder scratch;
  std::vector<DenseScene> scenes;
  for (const test::StereoScene& scene : test::middlebury_scenes(folder)) {
    const StereoSceneFile files = test::files_of(scene, scratch.path());
    DenseScene read;
    read.pair = {read_grey_levels(files.left), read_grey_levels(files.right)};
    read.edges = canny_edges(read.pair.left);
    const StereoTruth truth =
        read_stereo_truth(files, read.pair.left.width_px, read.pair.left.height_px);
    read.truth = truth_at(truth, read.edges);
    read.range = files.range;
    scenes.push_back(std::move(read));
  }
  return scenes;
}

/// Shares, of the edges more than 5° from horizontal whose truth is known.
struct Score {
  double density = 0;   ///< matched, of those that the right image shows
  double bad_1 = 0;     ///< wrong by more than 1 px, of these
  double mismatch = 0;  ///< wrong by more than 3 px, of all matched, occluded ones too
  double bad_1_smooth = 0, bad_1_step = 0;  ///< away from discontinuities and at them
};

Score score(const DenseScene& scene, const Matcher& matcher) {
  const auto found = matcher.match(scene.pair, scene.edges, scene.range);
  const float min_slope = static_cast<float>(std::sin(5 * std::numbers::pi / 180));
  double shown = 0, all = 0, mismatched = 0;
  std::array<double, 2> matched{}, bad_1{};  // away from discontinuities, at them
  for (std::size_t i = 0; i < found.size(); ++i) {
    const TruthAtEdge& truth = scene.truth[i];
    if (!truth.known || std::abs(scene.edges[i].normal.x()) < min_slope) continue;
    const float error = std::abs(found[i].disparity_px - truth.disparity_px);
    shown += !truth.occluded;
    all += found[i].matched();
    mismatched += error > 3;
    if (truth.occluded || !found[i].matched()) continue;
    matched[truth.discontinuity] += 1;
    bad_1[truth.discontinuity] += error > 1;
  }
  const double both = matched[0] + matched[1];
  return {both / shown, (bad_1[0] + bad_1[1]) / both, mismatched / all, bad_1[0] / matched[0],
          bad_1[1] / matched[1]};
}

Score mean_score(const std::vector<DenseScene>& scenes, const Matcher& matcher) {
  Score mean;
  for (const DenseScene& scene : scenes) {
    const Score one = score(scene, matcher);
    const double part = 1.0 / static_cast<double>(scenes.size());
    mean.density += part * one.density;
    mean.bad_1 += part * one.bad_1;
    mean.mismatch += part * one.mismatch;
    mean.bad_1_smooth += part * one.bad_1_smooth;
    mean.bad_1_step += part * one.bad_1_step;
  }
  return mean;
}

TEST(DenseMatchersOnMiddlebury, AreAsGoodAsTheirBestSettings) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  const std::vector<DenseScene> scenes = scenes_of(*folder);
  ASSERT_EQ(scenes.size(), 11u);
  const auto record = [&](const std::string& label, const Matcher& matcher) {
    const Score s = mean_score(scenes, matcher);
    char text[200];
    std::snprintf(text, sizeof text,
                  "density %.3f, bad-1 %.4f (%.4f away from discontinuities, %.4f at them), "
                  "mismatch %.4f",
                  s.density, s.bad_1, s.bad_1_smooth, s.bad_1_step, s.mismatch);
    RecordProperty(label, text);
    return s;
  };
  const Score of_bm = record("bm", bm()), of_sgbm = record("sgbm", sgbm());
  EXPECT_GT(of_bm.density, 0.90);
  EXPECT_LT(of_bm.bad_1, 0.028);
  EXPECT_LT(of_bm.mismatch, 0.017);
  EXPECT_GT(of_sgbm.density, 0.965);
  EXPECT_LT(of_sgbm.bad_1, 0.031);
  EXPECT_LT(of_sgbm.mismatch, 0.019);
  EXPECT_LT(of_sgbm.bad_1_smooth, 0.2 * of_sgbm.bad_1_step);
  SgbmOptions other;
  other.sampling = EdgeSampling::nearest;
  EXPECT_GT(record("sgbm_nearest", sgbm(other)).bad_1, of_sgbm.bad_1);
  other = {};
  other.speckle_px = 0;
  EXPECT_GT(record("sgbm_without_speckle_filter", sgbm(other)).bad_1, of_sgbm.bad_1);
  other = {};
  other.mode = SgbmMode::eight_paths;
  EXPECT_LT(record("sgbm_eight_paths", sgbm(other)).bad_1, 0.03);
}

}  // namespace
}  // namespace vernier
