// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The eleven Middlebury pairs' ground truth against their images: what is said to be seen looks
// alike in both, what is said to be occluded does not.
#include <gtest/gtest.h>

#include <cmath>

#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/grey_levels.h"
#include "stereo/stereo_truth.h"
#include "tests/support/data_folder.h"
#include "tests/support/foreign_files.h"
#include "tests/support/scene_files.h"
#include "tests/support/stereo_scenes.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

/// Median difference of grey levels between left pixels and where the truth says they are in the
/// right image, of those that are seen there and of those that are hidden behind something.
struct Likeness {
  double known = 0, hidden = 0;  ///< shares of all pixels
  double seen_grey = 0, hidden_grey = 0;
};

double median(std::vector<float> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

Likeness likeness(const StereoTruth& truth, const GreyLevels& left, const GreyLevels& right) {
  std::vector<float> seen, hidden;
  std::size_t known = 0;
  for (int y = 0; y < left.height_px; ++y) {
    for (int x = 0; x < left.width_px; ++x) {
      if (!truth.disparity.known(x, y)) continue;
      ++known;
      const float at = static_cast<float>(x) - truth.disparity(x, y);
      const int first = static_cast<int>(std::floor(at));
      if (first < 0 || first + 1 >= right.width_px) continue;
      const float part = at - static_cast<float>(first);
      const float grey = (1 - part) * right(first, y) + part * right(first + 1, y);
      const auto index = static_cast<std::size_t>(y * left.width_px + x);
      (truth.occluded[index] ? hidden : seen).push_back(std::abs(grey - left(x, y)));
    }
  }
  const auto pixels = static_cast<double>(left.values.size());
  return {static_cast<double>(known) / pixels, static_cast<double>(hidden.size()) / pixels,
          median(seen), median(hidden)};
}

TEST(TruthOfMiddlebury, HidesWhatLooksDifferentInTheRightImage) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  const test::Folder scratch;
  int scenes = 0;
  for (const test::StereoScene& scene : test::middlebury_scenes(*folder)) {
    const StereoSceneFile files = test::files_of(scene, scratch.path());
    const GreyLevels left = read_grey_levels(files.left), right = read_grey_levels(files.right);
    const StereoTruth truth = read_stereo_truth(files, left.width_px, left.height_px);
    const Likeness like = likeness(truth, left, right);
    EXPECT_GE(like.known, 0.79) << scene.name;
    EXPECT_GT(like.hidden, 0.001) << scene.name;
    EXPECT_LT(like.hidden, 0.15) << scene.name;
    EXPECT_LT(like.seen_grey, 4.5) << scene.name;
    EXPECT_GT(like.hidden_grey, 7 * like.seen_grey) << scene.name;
    StereoSceneFile left_only = files;
    left_only.right_truth.clear();
    const StereoTruth by_left = read_stereo_truth(left_only, left.width_px, left.height_px);
    EXPECT_NEAR(likeness(by_left, left, right).hidden, like.hidden, 0.01) << scene.name;
    ++scenes;
  }
  EXPECT_EQ(scenes, 11);
}

}  // namespace
}  // namespace vernier
