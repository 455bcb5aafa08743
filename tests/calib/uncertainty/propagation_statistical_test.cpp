// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "tests/support/chi_squared.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr int samples = 2000;
constexpr double psi_c = 0.02;  // where everything is linear: what parts there is a mistake
constexpr double alarm = 1e-3;  // of each test, over all its comparisons together (Bonferroni)

const RigEstimate& propagated_estimate() {
  static const RigEstimate estimate = calibrate(
      simulate_board(test::stereo_rig(), {9, 6, 0.04}, {.seed = 7, .frames = 12}).observations);
  return estimate;
}

/// Whether variances sampled at psi_c are those of the linear covariance: n − 1 of them over the
/// true one are chi-squared with n − 1 degrees of freedom.
template <typename Matrix>
void expect_same_variances(const Matrix& sampled, const Matrix& linear, double per_comparison) {
  for (Eigen::Index i = 0; i < linear.rows(); ++i) {
    const double statistic = (samples - 1) * sampled(i, i) / (psi_c * psi_c * linear(i, i));
    EXPECT_GT(statistic, test::chi_squared_quantile(samples - 1, per_comparison / 2));
    EXPECT_LT(statistic, test::chi_squared_quantile(samples - 1, 1 - per_comparison / 2));
  }
}

TEST(SampledPropagation, ProjectionIsTheLinearOneAtSmallPsi) {
  const RigSampler sampler(propagated_estimate());
  const RigAndBoards joint = rig_and_boards(propagated_estimate(), CovarianceChoice::honest);
  std::vector<FixedPoint> points;
  for (const double distance_m : {0.5, 2.0, std::numeric_limits<double>::infinity()}) {
    const bool far = std::isinf(distance_m);
    for (const auto& q : {Eigen::Vector2d(320, 240), {60, 50}, {590, 420}}) {
      const Eigen::Vector3d ray = unproject(propagated_estimate().rig.cameras[1], q).normalized();
      points.push_back({far ? ray : Eigen::Vector3d(distance_m * ray), far});
    }
  }
  for (int c = 0; c < 2; ++c) {
    for (const auto fixed_to :
         {PointFixedTo::boards, PointFixedTo::camera, PointFixedTo::first_camera}) {
      const ProjectionUncertainty linear(joint, c, fixed_to);
      const auto drawn = sampled_projection(sampler, joint, c, fixed_to, points,
                                            {.psi_c = psi_c, .samples = samples, .seed = 21});
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Eigen::Vector3d& x = points[k].x_camera;
        expect_same_variances(drawn[k].covariance,
                              points[k].at_infinity ? linear.covariance_of_direction(x)
                                                    : linear.covariance_of_point(x),
                              alarm / (2 * 3 * 9 * 2));
        EXPECT_EQ(drawn[k].non_physical_share, 0);
      }
    }
  }
}

TEST(SampledPropagation, TriangulationIsTheLinearOneAtSmallPsi) {
  const RigSampler sampler(propagated_estimate());
  const RigAndBoards joint = rig_and_boards(propagated_estimate(), CovarianceChoice::honest);
  std::vector<PixelPair> pairs;
  for (const auto& x : {Eigen::Vector3d(0, 0, 1), {0.3, -0.2, 1.5}, {-1, 0.5, 4}, {0.2, 0.1, 8}}) {
    pairs.push_back(*pixel_pair(propagated_estimate().rig, x));
  }
  for (const auto frame : {TriangulationFrame::rig, TriangulationFrame::stabilised}) {
    const TriangulationUncertainty linear(joint, frame);
    const auto drawn = sampled_triangulation(sampler, joint, frame, pairs, 0,
                                             {.psi_c = psi_c, .samples = samples, .seed = 22});
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      expect_same_variances(drawn[k].covariance, linear.at(pairs[k], 0)->calibration,
                            alarm / (2 * 4 * 3));
    }
  }
}

TEST(SampledPropagation, PixelNoiseOfThePairIsTheLinearOneWhereTheRigIsExact) {
  const RigSampler sampler(propagated_estimate());
  const std::vector<PixelPair> pairs{*pixel_pair(propagated_estimate().rig, {0.1, 0.2, 1.5})};
  const auto drawn = sampled_triangulation(sampler, {}, TriangulationFrame::rig, pairs, 0.1 * psi_c,
                                           {.psi_c = 0, .samples = samples, .seed = 23})[0];
  const TriangulationUncertainty linear(propagated_estimate().rig,
                                        propagated_estimate().covariance->matrix);
  expect_same_variances(drawn.covariance, linear.at(pairs[0], 0.1)->observation, alarm / 3);
}

TEST(SampledPropagation, DepthIntervalIsTheLinearOneAtSmallPsi) {
  const auto u = depth_uncertainty(propagated_estimate(), {2},
                                   {.psi_c = psi_c, .samples = samples, .seed = 24})[0];
  // The standard error of a 2.5 % quantile of n normal draws is sqrt(p(1-p)/n)/phi(z) = 2.67/√n
  // standard deviations; two ends, two-sided.
  const double band = normal_quantile(1 - alarm / 4) * 2.67 / std::sqrt(samples);
  EXPECT_NEAR((u.interval_95_m.low - 2) / u.sigma_linear_m, -1.96, band);
  EXPECT_NEAR((u.interval_95_m.high - 2) / u.sigma_linear_m, 1.96, band);
}

}  // namespace
}  // namespace vernier
