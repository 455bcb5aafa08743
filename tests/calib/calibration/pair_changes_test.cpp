// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The limits are those of boards (change_findings_test.cpp); seeds here chose nothing.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "calib/calibration/change_findings.h"
#include "calib/calibration/frame_scatter.h"
#include "calib/estimate/simulated_pairs.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "tests/support/pair_priors.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr int image_pairs = 10;

/// Image pairs of scenes of their own, each seen by the rig of its number.
PairObservations seen_by(const std::function<Rig(int)>& rig_of,
                         std::uint64_t seed,
                         const SimulatedPairsOptions& options = {.image_pairs = image_pairs}) {
  PairObservations all;
  SimulatedPairsOptions one = options;
  one.image_pairs = 1;
  for (int i = 0; i < options.image_pairs; ++i) {
    append(all, simulate_pairs(rig_of(i), seed + 1000 * static_cast<std::uint64_t>(i), 0, one));
  }
  return all;
}

PairObservations seen_by_one(std::uint64_t seed, const SimulatedPairsOptions& options) {
  return seen_by([](int) { return test::stereo_rig(); }, seed, options);
}

/// Moves every right corner by the shift of its image pair, and drops what leaves the image.
PairObservations shifted(PairObservations pairs, const std::function<Eigen::Vector2d(int)>& by) {
  const Eigen::Vector2d last = test::stereo_rig().cameras[1].size_px.cast<double>().array() - 1;
  std::vector<bool> inside(pairs.size());
  for (std::size_t i = 0; i < pairs.image_pairs.size(); ++i) {
    const ImagePair& image = pairs.image_pairs[i];
    const Eigen::Vector2d shift = by(static_cast<int>(i));
    for (std::size_t row = image.first; row < image.first + image.count; ++row) {
      const Eigen::Vector2d at = pairs.pixels_px[row].tail<2>() + shift;
      pairs.pixels_px[row].tail<2>() = at;
      inside[row] = (at.array() >= 0).all() && (at.array() <= last.array()).all();
    }
  }
  return selected(pairs, inside);
}

std::function<Eigen::Vector2d(int)> jitter(double most_px, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> draw(-most_px, most_px);
  std::vector<Eigen::Vector2d> shifts(image_pairs);
  for (Eigen::Vector2d& shift : shifts) {
    shift.x() = draw(random);
    shift.y() = draw(random);
  }
  return [shifts](int i) { return shifts[static_cast<std::size_t>(i)]; };
}

std::vector<std::string> doubts_of(const PairObservations& pairs, std::uint32_t trial) {
  const GaussianRigPrior known = test::datasheet(test::stereo_rig(), 71, trial);
  return calibrate_from_pairs(pairs, known).estimate.calibration->trust_warnings;
}

TEST(PairChanges, RightImagesThatAreOffFromPairToPairAreNamed) {
  for (const double px : {2.0, 4.0}) {
    const auto doubts =
        doubts_of(shifted(seen_by_one(81, {.image_pairs = image_pairs}), jitter(px, 5)), 1);
    ASSERT_EQ(doubts.size(), 1u) << px;
    EXPECT_EQ(doubts[0].find("the rig is not the same in all image pairs: another "), 0u)
        << doubts[0];
  }
}

// The covariance, clustered by image pair, holds them.
TEST(PairChanges, SmallOnesAreNamedWithoutDoubt) {
  const PairObservations pairs = shifted(
      seen_by_one(86, {.image_pairs = image_pairs, .pixel_sigma_px = 0.08}), jitter(0.5, 6));
  const GaussianRigPrior known = test::datasheet(test::stereo_rig(), 71, 6);
  const CalibrationSummary said = *calibrate_from_pairs(pairs, known).estimate.calibration;
  EXPECT_TRUE(said.trust_warnings.empty());
  ASSERT_FALSE(said.warnings.empty());
  EXPECT_EQ(said.warnings[0].find("the rig is not the same in all image pairs: another "), 0u)
      << said.warnings[0];
}

TEST(PairChanges, OneChangeIsNamedWithItsImagePair) {
  const Rig before = test::stereo_rig();
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(parameter_count(before));
  turn[pose_index(before, 1)] = 0.004;  // 2 px down
  const Rig after = retract(before, turn);
  const PairObservations pairs = seen_by([&](int i) { return i < 6 ? before : after; }, 82);
  const auto doubts = doubts_of(pairs, 2);
  ASSERT_EQ(doubts.size(), 1u);
  const std::string number = std::to_string(pairs.image_pairs[5].number);
  EXPECT_EQ(doubts[0].find("the rig changed after image pair " + number + ": another"), 0u)
      << doubts[0];
}

TEST(PairChanges, AZoomedLensIsNamedAsALens) {
  const Rig before = test::stereo_rig();
  Eigen::VectorXd zoom = Eigen::VectorXd::Zero(parameter_count(before));
  zoom[intrinsics_index(before, 1)] = 0.03 * before.cameras[1].parameters[0];
  const Rig after = retract(before, zoom);
  const auto doubts = doubts_of(seen_by([&](int i) { return i < 5 ? before : after; }, 83), 3);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("the rig changed after image pair"), std::string::npos) << doubts[0];
  EXPECT_NE(doubts[0].find("lens of camera"), std::string::npos) << doubts[0];
}

/// Whether a change is named, with doubt or without.
bool names_a_change(const CalibrationSummary& said) {
  const auto names = [](const std::vector<std::string>& lines) {
    return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find("the rig changed") == 0 || line.find("the rig is not the same") == 0;
    });
  };
  return names(said.trust_warnings) || names(said.warnings);
}

// What all image pairs share is another rig, and its conflict with the prior is another doubt.
TEST(PairChanges, AConstantShiftIsNoChange) {
  const auto always = [](int) { return Eigen::Vector2d(0, 80); };
  const PairObservations pairs = shifted(seen_by_one(84, {.image_pairs = image_pairs}), always);
  const GaussianRigPrior known = test::datasheet(test::stereo_rig(), 71, 4);
  const CalibrationSummary said = *calibrate_from_pairs(pairs, known).estimate.calibration;
  EXPECT_FALSE(names_a_change(said));
  EXPECT_FALSE(said.trust_warnings.empty());
}

TEST(PairChanges, WrongMatchesAreNoChange) {
  for (std::uint64_t seed = 85; seed < 90; ++seed) {
    const PairObservations pairs =
        seen_by_one(seed, {.image_pairs = image_pairs, .wrong_share = 0.2});
    const GaussianRigPrior known = test::datasheet(test::stereo_rig(), 71, 5);
    const CalibrationSummary said = *calibrate_from_pairs(pairs, known).estimate.calibration;
    EXPECT_FALSE(names_a_change(said)) << seed;
    EXPECT_TRUE(said.trust_warnings.empty()) << seed << said.trust_warnings[0];
  }
}

// Their matches are outliers, a fifth of all: no share of the inliers shows them.
TEST(PairChanges, AFewImagePairsOfAnotherRigAreNamed) {
  const auto last_two = [](int i) { return Eigen::Vector2d(0, i < 8 ? 0 : 12); };
  const PairObservations pairs = shifted(seen_by_one(87, {.image_pairs = image_pairs}), last_two);
  const auto doubts = doubts_of(pairs, 7);
  ASSERT_EQ(doubts.size(), 1u);
  const std::string numbers = std::to_string(pairs.image_pairs[8].number) + ", " +
                              std::to_string(pairs.image_pairs[9].number);
  EXPECT_EQ(doubts[0].find("most matches of image pairs " + numbers + " were left out"), 0u)
      << doubts[0];
}

TEST(PairChanges, FewImagePairsAreNotTested) {
  EXPECT_TRUE(frame_scatter(seen_by_one(90, {.image_pairs = 3}), test::stereo_rig()).empty());
}

// Of white noise both shares are near zero, so no limit is near: 40 sets, none accused.
TEST(PairChanges, WhiteNoiseIsNotAccused) {
  double mean_f = 0, largest = 0;
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    const PairObservations pairs =
        seen_by_one(seed, {.image_pairs = 6 + static_cast<int>(seed % 7)});
    const GaussianRigPrior known =
        test::datasheet(test::stereo_rig(), 71, static_cast<std::uint32_t>(seed));
    const CalibrationSummary said = *calibrate_from_pairs(pairs, known).estimate.calibration;
    EXPECT_TRUE(said.trust_warnings.empty() && !names_a_change(said)) << seed;
    for (const FrameScatter& s : frame_scatter(pairs, test::stereo_rig())) {
      largest = std::max(largest, s.share);
      if (s.kept == Kept::pose && !s.is_split) mean_f += s.f_ratio / 40;
    }
  }
  EXPECT_LT(largest, 0.1);
  EXPECT_GT(mean_f, 0.6);  // the rig took some of the directions
  EXPECT_LT(mean_f, 1.1);
}

}  // namespace
}  // namespace vernier
