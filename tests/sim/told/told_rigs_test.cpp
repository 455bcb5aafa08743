// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/told_rigs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "sim/told/fresh_calibrations.h"
#include "sim/told/possible_rig.h"
#include "tests/support/error_message.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

const RigEstimate& true_rig() { return test::nominal_rig(); }

bool same_rig(const Rig& a, const Rig& b) { return parameters(a) == parameters(b); }

bool same_views(const BoardView& a, const BoardView& b) {
  return a.frame == b.frame && a.camera == b.camera && a.ids == b.ids && a.pixels_px == b.pixels_px;
}

std::string message_of(const auto& work) { return test::error_message(work); }

TEST(ToldRigs, DrawsAreThoseOfTheSamplerAboutTheTruth) {
  const auto told = drawn_rigs(true_rig().rig, *true_rig().covariance, 2, 7, "told.json");
  const RigSampler sampler(true_rig());
  for (const std::uint32_t draw : {0u, 5u, 0x80000003u}) {
    EXPECT_TRUE(same_rig(told->told(draw).rig, sampler.sample(2, 7, draw)));
    EXPECT_FALSE(same_rig(told->told(draw).rig, true_rig().rig));
  }
}

TEST(ToldRigs, NoErrorIsTheTruthToTheBit) {
  Rig other = true_rig().rig;
  other.cameras[0].parameters[0] += 3;
  auto calibrations = std::make_shared<const FreshCalibrations>(
      true_rig().rig, FreshCalibrationOptions{.views = 4}, 1);
  for (const auto& told : {drawn_rigs(true_rig().rig, *true_rig().covariance, 0, 7, "told.json"),
                           given_rig(true_rig().rig, other, 0, "told.json"),
                           given_rig(true_rig().rig, true_rig().rig, 1, "told.json"),
                           calibrated_rigs(calibrations, 0)}) {
    EXPECT_TRUE(same_rig(told->told(3).rig, true_rig().rig));
    EXPECT_EQ(told->told(3).failure, "");
  }
}

TEST(ToldRigs, AGivenErrorScalesInTheTangent) {
  const Rig given = RigSampler(true_rig()).sample(3, 1, 0);
  const Eigen::VectorXd whole = difference(given, true_rig().rig);
  const Rig third = given_rig(true_rig().rig, given, 1.0 / 3, "told.json")->told(0).rig;
  EXPECT_LT((difference(third, true_rig().rig) - whole / 3).norm(), 1e-12 * (1 + whole.norm()));
  EXPECT_TRUE(same_rig(given_rig(true_rig().rig, given, 1, "told.json")->told(9).rig, given));
}

TEST(ToldRigs, AnotherLensModelIsToldAsItIsAndNotScaled) {
  const Rig richer = in_models(true_rig().rig, {OpenCv4{}, OpenCv4{}});
  EXPECT_TRUE(same_rig(given_rig(true_rig().rig, richer, 1, "told.json")->told(0).rig, richer));
  EXPECT_NE(message_of([&] {
              given_rig(true_rig().rig, richer, 2, "told.json");
            }).find("told.json: sources.calibration = 2 cannot scale"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              Covariance covariance = *true_rig().covariance;
              drawn_rigs(richer, covariance, 1, 1, "told.json");
            }).find("told.json: its covariance is over other parameters"),
            std::string::npos);
}

TEST(ToldRigs, OtherCamerasAreRefused) {
  Rig one = true_rig().rig;
  one.cameras.pop_back();
  one.T_camera_first.pop_back();
  EXPECT_NE(message_of([&] {
              given_rig(true_rig().rig, one, 1, "told.json");
            }).find("told.json: has 1 cameras and the true rig 2"),
            std::string::npos);
  Rig wide = true_rig().rig;
  wide.cameras[1].size_px = {1280, 720};
  EXPECT_NE(message_of([&] {
              given_rig(true_rig().rig, wide, 1, "told.json");
            }).find("the images of camera 1 are 1280x720"),
            std::string::npos);
}

TEST(FreshCalibrations, FewerViewsAreTheFirstOfMore) {
  const FreshCalibrations five(true_rig().rig, {.views = 5}, 11),
      ten(true_rig().rig, {.views = 10}, 11);
  for (const std::uint32_t draw : {0u, 1u, 0x80000000u}) {
    const auto few = five.views_of(draw).views, many = ten.views_of(draw).views;
    ASSERT_EQ(few.size(), 10u);
    ASSERT_EQ(many.size(), 20u);
    for (std::size_t i = 0; i < few.size(); ++i) EXPECT_TRUE(same_views(few[i], many[i]));
  }
  // Draws and seeds take other views.
  const FreshCalibrations other(true_rig().rig, {.views = 5}, 12);
  EXPECT_FALSE(same_views(five.views_of(0).views[0], five.views_of(1).views[0]));
  EXPECT_FALSE(same_views(five.views_of(0).views[0], other.views_of(0).views[0]));
}

TEST(FreshCalibrations, SubsetsOfRealViewsAreNestedToo) {
  const auto all = std::make_shared<const BoardObservations>(
      simulate_board(true_rig().rig, {}, {.seed = 3, .frames = 12}).observations);
  const FreshCalibrations four(true_rig().rig, {.views = 4}, 5, all);
  const FreshCalibrations nine(true_rig().rig, {.views = 9}, 5, all);
  std::vector<std::vector<int>> seen;
  for (std::uint32_t draw = 0; draw < 20; ++draw) {
    const std::vector<int> few = frames_of(four.views_of(draw));
    const std::vector<int> many = frames_of(nine.views_of(draw));
    EXPECT_EQ(few.size(), 4u);
    EXPECT_EQ(many.size(), 9u);
    EXPECT_TRUE(std::includes(many.begin(), many.end(), few.begin(), few.end()));
    seen.push_back(few);
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_GT(std::unique(seen.begin(), seen.end()) - seen.begin(), 15);
  EXPECT_NE(message_of([&] {
              FreshCalibrations(true_rig().rig, {.views = 13}, 5, all);
            }).find("calibration.views = 13: the corners are of 12 frames"),
            std::string::npos);
}

TEST(FreshCalibrations, AreTheProjectsOwnCalibrateWhateverWasAskedBefore) {
  const FreshCalibrations calibrations(true_rig().rig, {.views = 5}, 11);
  const auto later = calibrations.of(4);
  const FreshCalibrations again(true_rig().rig, {.views = 5}, 11);
  again.of(0);
  again.of(7);
  EXPECT_TRUE(same_rig(later->rig, again.of(4)->rig));
  EXPECT_EQ(calibrations.of(4), later);  // kept
  const RigEstimate whole = calibrate(calibrations.views_of(4), {.model = Radial1{}});
  EXPECT_TRUE(same_rig(later->rig, whole.rig));
  EXPECT_EQ(later->covariance, whole.covariance->matrix);
}

// Errors over 30 calibrations: below the bound by chance with p < 1e-6 if they shrink as 1/sqrt(n).
TEST(FreshCalibrations, MoreViewsGiveASmallerError) {
  const FreshCalibrations few(true_rig().rig, {.views = 5}, 2),
      many(true_rig().rig, {.views = 20}, 2);
  const CalibrationRecord of_few = record_of(few, 30), of_many = record_of(many, 30);
  EXPECT_EQ(of_few.calibrations, 30);
  EXPECT_EQ(of_many.failed, 0);
  EXPECT_GT(of_few.depth_error_m, 1.5 * of_many.depth_error_m);
  EXPECT_GT(of_many.depth_sd_m, 0.5 * of_many.depth_error_m);
  EXPECT_LT(of_many.depth_sd_m, 2 * of_many.depth_error_m);
}

TEST(FreshCalibrations, AFailureIsCountedAndSaid) {
  // Boards that face the camera do not determine focal lengths.
  const FreshCalibrations flat(true_rig().rig, {.views = 3, .tilt_rad = 1e-4}, 2);
  const CalibrationRecord record = record_of(flat, 5);
  EXPECT_EQ(record.failed, 5);
  EXPECT_FALSE(record.why_failed.empty());
  EXPECT_TRUE(std::isnan(record.depth_error_m));
  const auto told =
      calibrated_rigs(std::make_shared<const FreshCalibrations>(
                          true_rig().rig, FreshCalibrationOptions{.views = 3, .tilt_rad = 1e-4}, 2),
                      1);
  EXPECT_EQ(told->told(0).failure, record.why_failed);
}

TEST(ToldRigs, ARigThatNoCamerasCanHaveIsAFailureAndNoRig) {
  const auto failing = [](const Rig& rig) { return impossible(rig); };
  EXPECT_EQ(failing(true_rig().rig), "");
  const auto changed = [&](int parameter, double value) {
    Rig rig = true_rig().rig;
    rig.cameras[1].parameters[parameter] = value;
    return rig;
  };
  EXPECT_EQ(failing(changed(0, -500)), "right.f_px is not positive");
  EXPECT_EQ(failing(changed(1, 0)), "right.ax is not positive");
  EXPECT_EQ(failing(changed(2, 1e5)), "right: its centre is far outside the image");
  EXPECT_EQ(failing(changed(3, -1e5)), "right: its centre is far outside the image");
  EXPECT_EQ(failing(changed(2, -100)), "");  // of an image that was cut
  EXPECT_EQ(failing(changed(2, std::nan(""))), "a parameter is not finite");

  const auto given = given_rig(true_rig().rig, changed(0, 450), 20, "told.json")->told(0);
  EXPECT_NE(given.failure.find("right.f_px is not positive"), std::string::npos) << given.failure;
  EXPECT_EQ(given_rig(true_rig().rig, changed(0, 450), 1, "told.json")->told(0).failure, "");
  // Of draws that are larger and larger the first are rigs, the same as without the check.
  int failed = 0;
  for (const double psi_c : {1.0, 1e3, 1e5, 1e200, 1e308}) {
    const auto drawn = drawn_rigs(true_rig().rig, *true_rig().covariance, psi_c, 7, "told.json");
    for (std::uint32_t draw = 0; draw < 10; ++draw) {
      const ToldRig told = drawn->told(draw);
      if (told.failure.empty()) {
        EXPECT_TRUE(same_rig(told.rig, RigSampler(true_rig()).sample(psi_c, 7, draw)));
      }
      failed += told.failure.empty() ? 0 : 1;
      EXPECT_TRUE(psi_c > 1 || told.failure.empty());
      EXPECT_TRUE(psi_c < 1e200 || !told.failure.empty());
    }
  }
  EXPECT_GT(failed, 20);
}

// A detector reports no corners outside of the image; the others keep their draws.
TEST(FreshCalibrations, CornersThatNoiseCarriesOutAreLeftOut) {
  const FreshCalibrationOptions noisy{.views = 6, .pixel_sigma_px = 20};
  const FreshCalibrations calibrations(true_rig().rig, noisy, 3);
  std::size_t left_out = 0;
  for (std::uint32_t draw = 0; draw < 20; ++draw) {
    const BoardObservations seen = calibrations.views_of(draw);
    const BoardObservations all =
        simulate_board(true_rig().rig, noisy.board,
                       {.seed = 3, .trial = draw, .poses = draw, .frames = 6, .pixel_sigma_px = 20})
            .observations;
    for (const BoardView& view : seen.views) {
      const auto whole = std::find_if(all.views.begin(), all.views.end(), [&](const auto& v) {
        return v.frame == view.frame && v.camera == view.camera;
      });
      ASSERT_NE(whole, all.views.end());
      std::size_t i = 0;
      for (std::size_t j = 0; j < whole->ids.size(); ++j) {
        const Eigen::Vector2d& p = whole->pixels_px[j];
        if (p.x() < -0.5 || p.y() < -0.5 || p.x() > 639.5 || p.y() > 479.5) {
          ++left_out;
          continue;
        }
        ASSERT_LT(i, view.ids.size());
        EXPECT_EQ(view.ids[i], whole->ids[j]);
        EXPECT_EQ(view.pixels_px[i++], p);
      }
      EXPECT_EQ(i, view.ids.size());
    }
    EXPECT_EQ(calibrations.of(draw)->failure.find("outside"), std::string::npos)
        << calibrations.of(draw)->failure;
  }
  EXPECT_GT(left_out, 0u);
}

TEST(FreshCalibrations, OnlyTheLatestAreKeptAndTheOthersAreTheSameAgain) {
  const FreshCalibrations few(true_rig().rig, {.views = 3, .most_kept = 3}, 11),
      all(true_rig().rig, {.views = 3}, 11);
  std::vector<std::shared_ptr<const FreshCalibration>> held;
  for (const std::uint32_t draw : {0u, 0x80000000u, 1u, 2u, 3u, 1u, 0u, 0x80000000u, 4u}) {
    held.push_back(few.of(draw));
    EXPECT_LE(few.kept(), 3u);
    EXPECT_EQ(held.back()->failure, all.of(draw)->failure);
    EXPECT_TRUE(same_rig(held.back()->rig, all.of(draw)->rig));
  }
  EXPECT_EQ(all.kept(), 6u);
  EXPECT_TRUE(same_rig(held[0]->rig, held[6]->rig));
}

}  // namespace
}  // namespace vernier
