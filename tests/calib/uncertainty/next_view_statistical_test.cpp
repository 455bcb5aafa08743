// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "calib/uncertainty/next_view.h"
#include "calib/uncertainty/target_quantity.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double drawn_sigma_px = 0.2;
constexpr int views_before = 6;

/// Depth errors at 5 m over calibrations of the same views with fresh noise.
class DepthTrials {
 public:
  DepthTrials()
      : first_(simulate_board(
            truth_, {}, {.seed = 31, .frames = views_before, .pixel_sigma_px = 0})) {}

  const Rig& truth() const { return truth_; }
  const SimulatedBoard& first() const { return first_; }

  /// Root mean square error of the depth at 5 m over `trials` with these views added.
  double rms(const std::vector<Pose>& added, int trials) const {
    BoardObservations exact = first_.observations;
    for (std::size_t k = 0; k < added.size(); ++k) append(exact, added[k], views_before + int(k));
    const Eigen::Vector3d x(0, 0, 5);
    const Eigen::Vector2d left = project(truth_.cameras[0], x);
    const Eigen::Vector2d right = project(truth_.cameras[1], truth_.T_camera_first[1] * x);
    double squares = 0;
    for (int trial = 0; trial < trials; ++trial) {
      BoardObservations noisy = exact;
      for (BoardView& view : noisy.views) {
        RandomStream draws({.seed = 77,
                            .trial = static_cast<std::uint32_t>(trial),
                            .feature = static_cast<std::uint32_t>(64 * view.frame + view.camera)});
        for (auto& q : view.pixels_px) q += drawn_sigma_px * Eigen::Vector2d(draws.normals(2));
      }
      const Rig rig = calibrate(noisy, {.pixel_sigma_px = drawn_sigma_px,
                                        .reject_outliers = false,
                                        .white_noise = true})
                          .rig;
      squares += std::pow(triangulated_depth_m(rig, {left, right}) - 5, 2);
    }
    return std::sqrt(squares / trials);
  }

 private:
  void append(BoardObservations& observations, const Pose& T_first_board, int frame) const {
    for (int c = 0; c < 2; ++c) {
      BoardView view{frame, c, "", {}, {}};
      for (std::size_t i = 0; i < observations.target_m.size(); ++i) {
        const Eigen::Vector3d x =
            truth_.T_camera_first[c] * (T_first_board * observations.target_m[i]);
        view.ids.push_back(static_cast<int>(i));
        view.pixels_px.push_back(project(truth_.cameras[c], x));
      }
      observations.views.push_back(std::move(view));
    }
  }

  Rig truth_ = test::stereo_rig();
  SimulatedBoard first_;
};

std::vector<Pose> advised(const DepthTrials& trials, int views) {
  const RigEstimate now = calibrate(trials.first().observations,
                                    {.pixel_sigma_px = drawn_sigma_px, .white_noise = true});
  const ViewAdvice advice = advise_views(
      ScaledDecomposition(*now.covariance).factor(),
      candidate_views(now.rig, trials.first().observations.target_m, {0, 0}, drawn_sigma_px),
      target_quantity(now.rig, "depth", 5), {.views = views, .more = 1});
  std::vector<Pose> poses;
  for (const ScoredView& view : advice.views) poses.push_back(view.placement.T_first_board);
  return poses;
}

/// The rms with the advised views, and those with 7 random sets of as many (seeds 500 to 506). Each
/// has a standard deviation of 9 %, and less in ratios, since all share the first views' noise.
void expect_better_than_most(int views) {
  const DepthTrials trials;
  const int count = 60;
  const double by_advice = trials.rms(advised(trials, views), count);
  std::vector<double> by_chance;
  for (std::uint64_t seed = 500; seed < 507; ++seed) {
    const auto random = simulate_board(trials.truth(), {}, {.seed = seed, .frames = views});
    by_chance.push_back(trials.rms(random.truth.T_first_board, count));
  }
  std::sort(by_chance.begin(), by_chance.end());
  testing::Test::RecordProperty("rms_advised_m", std::to_string(by_advice));
  testing::Test::RecordProperty("rms_random_median_m", std::to_string(by_chance[3]));
  testing::Test::RecordProperty("rms_random_best_m", std::to_string(by_chance[0]));
  testing::Test::RecordProperty("rms_without_m", std::to_string(trials.rms({}, count)));
  EXPECT_LT(by_advice, 0.75 * by_chance[3]);
}

TEST(NextView, OneAdvisedViewBeatsTheMedianRandomView) { expect_better_than_most(1); }

TEST(NextView, ThreeAdvisedViewsBeatThreeRandomOnes) { expect_better_than_most(3); }

}  // namespace
}  // namespace vernier
