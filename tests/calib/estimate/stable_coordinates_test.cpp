// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/stable_coordinates.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/estimate/covariance_curvature.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_difference.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// The cameras of the tests with a longer lens: 12° of view at a focal length of 3000 px.
Rig rig_with_lens(double f_px, const CameraModel& model = Radial1{}) {
  Rig rig = test::stereo_rig(model);
  for (Camera& camera : rig.cameras) {
    camera.parameters[0] *= f_px / 525;
    camera.parameters.tail(camera.parameters.size() - 4).setZero();
  }
  return rig;
}

SimulatedBoardOptions views_of(const Rig& rig, std::uint64_t seed) {
  return {.seed = seed, .frames = 20, .distance_m = rig.cameras[0].f_px() / 1000, .tilt_rad = 0.7};
}

RigEstimate calibrated(const Rig& rig, std::uint64_t seed, const CameraModel& model = Radial1{}) {
  const auto board = simulate_board(rig, {}, views_of(rig, seed));
  return calibrate(board.observations,
                   {.model = model, .pixel_sigma_px = 0.2, .white_noise = true});
}

const RigEstimate& narrow() {
  static const RigEstimate estimate = calibrated(rig_with_lens(3000), 1);
  return estimate;
}

Eigen::VectorXd sigma_of(const RigEstimate& estimate) {
  return estimate.covariance->matrix.diagonal().cwiseMax(0).cwiseSqrt();
}

double squared_distance(const Eigen::VectorXd& delta, const Eigen::MatrixXd& C) {
  const Eigen::VectorXd d = C.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = d.cwiseInverse().asDiagonal() * C * d.cwiseInverse().asDiagonal();
  const Eigen::VectorXd z = delta.cwiseQuotient(d);
  return z.dot(Eigen::LLT<Eigen::MatrixXd>(scaled).solve(z));
}

TEST(StableCoordinates, AreTheTangentToFirstOrder) {
  const std::vector<RigEstimate> estimates{narrow(),
                                           calibrated(test::stereo_rig(OpenCv4{}), 2, OpenCv4{}),
                                           calibrated(test::stereo_rig(Fisheye4{}), 3, Fisheye4{})};
  for (const RigEstimate& estimate : estimates) {
    const StableCoordinates about(estimate.rig, estimate.covariance->matrix);
    const RigSampler sampler(estimate);
    const Eigen::VectorXd sigma = sigma_of(estimate);
    for (std::uint32_t trial = 0; trial < 5; ++trial) {
      constexpr double small = 1e-5;
      const Eigen::VectorXd delta = sampler.deviation(small, 4, trial);
      const auto moved = about.try_rig(delta);
      ASSERT_TRUE(moved);
      const auto off = [&](const Eigen::VectorXd& found) {
        return (found - delta).cwiseQuotient(sigma).norm() / small;
      };
      EXPECT_LT(off(difference(moved->rig, estimate.rig)), 1e-2);
      EXPECT_LT(off(about.try_coordinates(retract(estimate.rig, delta)).value()), 1e-2);
      EXPECT_LT(off(about.try_coordinates(moved->rig).value()), 1e-4);
    }
  }
}

TEST(StableCoordinates, DescribeTheErrorsOfANarrowLensThatTheTangentDoesNot) {
  // 40 independent calibrations; two-sided false alarm 1e-4 for the mean of the squared distances.
  const Rig truth = rig_with_lens(3000);
  double stable = 0, tangent = 0;
  constexpr int trials = 40;
  for (int i = 0; i < trials; ++i) {
    const RigEstimate found = calibrated(truth, 100 + static_cast<std::uint64_t>(i));
    const Eigen::MatrixXd& C = found.covariance->matrix;
    const StableCoordinates about(found.rig, C);
    stable += squared_distance(about.try_coordinates(truth).value(), C);
    tangent += squared_distance(difference(truth, found.rig), C);
  }
  const double dof = trials * 16;
  EXPECT_GT(stable, chi_squared_quantile(5e-5, dof));
  EXPECT_LT(stable, chi_squared_quantile(1 - 5e-5, dof));
  EXPECT_GT(tangent, 2 * dof);
}

TEST(StableCoordinates, IndependentCalibrationsOfANarrowLensAgree) {
  // 20 pairs; one-sided false alarm 1e-4.
  const Rig truth = rig_with_lens(3000);
  double sum = 0;
  constexpr int pairs = 20;
  for (int i = 0; i < pairs; ++i) {
    const RigEstimate a = calibrated(truth, 200 + static_cast<std::uint64_t>(i)),
                      b = calibrated(truth, 300 + static_cast<std::uint64_t>(i));
    const RigDifference d = rig_difference(a.rig, *a.covariance, b.rig, *b.covariance);
    EXPECT_EQ(d.dof, 16);
    sum += d.mahalanobis2;
  }
  EXPECT_LT(sum, chi_squared_quantile(1 - 1e-4, pairs * 16));
  EXPECT_GT(sum, chi_squared_quantile(1e-4, pairs * 16));
}

TEST(StableCoordinates, SampledProjectionsOfANarrowLensAreTheLinearOnes) {
  const RigSampler sampler(narrow());
  const RigAndBoards joint = rig_and_boards(narrow(), CovarianceChoice::honest);
  constexpr double distance_m = 3;
  for (int camera : {0, 1}) {
    for (const auto fixed_to : {PointFixedTo::boards, PointFixedTo::first_camera}) {
      if (camera == 0 && fixed_to == PointFixedTo::first_camera) continue;  // tens of pixels
      std::vector<FixedPoint> points;
      for (const Eigen::Vector2d& q : {Eigen::Vector2d(320, 240), {100, 100}, {500, 400}}) {
        points.push_back({distance_m * unproject(narrow().rig.cameras[camera], q)});
      }
      const ProjectionUncertainty linear(joint, camera, fixed_to);
      const auto drawn = sampled_projection(sampler, joint, camera, fixed_to, points,
                                            {.samples = 1000, .seed = 5});
      for (std::size_t k = 0; k < points.size(); ++k) {
        const double expected = worst_sd(linear.covariance_of_point(points[k].x_camera));
        EXPECT_NEAR(worst_sd(drawn[k].covariance), expected, 0.25 * expected)
            << camera << " " << static_cast<int>(fixed_to) << " " << k;
      }
    }
  }
}

/// Of the coordinates of `rig` about `mean`, against central differences.
void expect_right_derivatives(const Rig& rig, const Rig& mean, const Eigen::MatrixXd& covariance) {
  const StableCoordinates about(mean, covariance);
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const auto at = about.try_position(rig);
  ASSERT_TRUE(at);
  EXPECT_EQ(at->delta, about.try_coordinates(rig).value());
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    if (!(sigma[i] > 0)) continue;
    const Eigen::VectorXd step = 1e-3 * sigma[i] * Eigen::VectorXd::Unit(sigma.size(), i);
    const Eigen::VectorXd numeric = (about.try_coordinates(retract(rig, step)).value() -
                                     about.try_coordinates(retract(rig, -step)).value()) /
                                    (2 * step[i]);
    for (Eigen::Index k = 0; k < sigma.size(); ++k) {
      const double off = (at->by_rig(k, i) - numeric[k]) * sigma[i];
      EXPECT_LT(std::abs(off), sigma[k] > 0 ? 1e-4 * sigma[k] : 1e-12) << k << " by " << i;
    }
  }
}

TEST(StableCoordinates, DerivativesAreThoseOfDifferences) {
  expect_right_derivatives(rig_with_lens(3000), narrow().rig, narrow().covariance->matrix);
}

TEST(StableCoordinates, DerivativesOfUnlikeCamerasSomeOfThemHeld) {
  Rig mean = test::stereo_rig(OpenCv5{});
  mean.cameras.push_back(test::stereo_rig(Fisheye4{}).cameras[1]);
  mean.cameras[2].name = "third";
  mean.cameras[2].parameters[0] = 300;
  mean.T_camera_first.push_back(
      {rotation_from_vector({-0.1, 0.05, 0.2}), Eigen::Vector3d(0.1, 0.3, -0.02)});
  mean.cameras[1] = rig_with_lens(900).cameras[1];  // with another model
  Eigen::VectorXd sigma(parameter_count(mean));
  for (int c = 0; c < 3; ++c) {
    auto intrinsics = sigma.segment(intrinsics_index(mean, c), mean.cameras[c].parameters.size());
    intrinsics.setConstant(3e-3);
    intrinsics.head<4>() << 4, 2e-3, 3, 2;
    if (c > 0) sigma.segment<6>(pose_index(mean, c)) << 4e-3, 4e-3, 2e-3, 2e-3, 2e-3, 4e-3;
  }
  sigma[intrinsics_index(mean, 0) + 1] = 0;                   // the first aspect factor
  sigma.segment<2>(intrinsics_index(mean, 2) + 2).setZero();  // the third principal point
  const Eigen::MatrixXd C = sigma.cwiseAbs2().asDiagonal();
  RandomStream random({.seed = 9});
  for (int trial = 0; trial < 3; ++trial) {
    const Eigen::VectorXd delta =
        sigma.cwiseProduct(random.normals(static_cast<int>(sigma.size())));
    const auto moved = StableCoordinates(mean, C).try_rig(delta);
    ASSERT_TRUE(moved);
    expect_right_derivatives(moved->rig, mean, C);
  }
}

TEST(StableCoordinates, ACalibrationOfANarrowLensServesAsAPrior) {
  // 15 pairs of halves; one-sided false alarm 1e-4.
  const Rig truth = rig_with_lens(3000);
  double sum = 0;
  constexpr int trials = 15;
  for (int i = 0; i < trials; ++i) {
    const RigEstimate first = calibrated(truth, 400 + static_cast<std::uint64_t>(i));
    const auto board =
        simulate_board(truth, {}, views_of(truth, 500 + static_cast<std::uint64_t>(i)));
    CalibrationOptions options{.model = Radial1{}, .pixel_sigma_px = 0.2, .white_noise = true};
    options.prior = gaussian_prior_of(first, "first");
    const RigEstimate both = calibrate(board.observations, options);
    const Eigen::MatrixXd& C = both.covariance->matrix;
    sum += squared_distance(StableCoordinates(both.rig, C).try_coordinates(truth).value(), C);
  }
  EXPECT_LT(sum, chi_squared_quantile(1 - 1e-4, trials * 16));
  EXPECT_GT(sum, chi_squared_quantile(1e-4, trials * 16));
}

// A camera that may not turn cannot follow its principal point: the tangent is right then.
TEST(StableCoordinates, WithAPoseHeldInPartTheyAreTheTangent) {
  const Rig truth = rig_with_lens(3000);
  for (const std::vector<HeldParameter>& held :
       {std::vector<HeldParameter>{{"right.wx_rad", {}}},
        {{"right.tx_m", {}}},
        {{"right.wx_rad", {}}, {"right.wy_rad", {}}, {"right.wz_rad", {}}}}) {
    const auto board = simulate_board(truth, {}, views_of(truth, 8));
    CalibrationOptions options{.pixel_sigma_px = 0.2, .white_noise = true};
    for (HeldParameter known : held) {
      const auto names = parameter_names(truth);
      known.value =
          parameters(truth)[std::find(names.begin(), names.end(), known.name) - names.begin()];
      options.held.push_back(known);
    }
    const RigEstimate found = calibrate(board.observations, options);
    const StableCoordinates about(found.rig, found.covariance->matrix);
    const Eigen::VectorXd delta = RigSampler(found).deviation(1, 6, 0);
    const Rig moved = about.try_rig(delta)->rig;
    EXPECT_EQ(parameters(moved), parameters(retract(found.rig, delta)));
    EXPECT_LT((about.try_coordinates(moved).value() - delta).norm(), 1e-9 * delta.norm());
    EXPECT_LT(covariance_curvature(found.rig, *found.covariance), 1e-9);
  }
}

// A fisheye whose image circle is smaller than its image: few pixels have a ray.
TEST(StableCoordinates, ALensWithFewRaysKeepsItsTangent) {
  Rig rig = test::stereo_rig(Fisheye4{});
  for (Camera& camera : rig.cameras) {
    camera.parameters[0] = 60;
    camera.parameters.tail<4>().setZero();
  }
  const auto n = static_cast<Eigen::Index>(parameter_count(rig));
  const Covariance C{CovarianceKind::mvb, parameter_names(rig),
                     1e-8 * Eigen::MatrixXd::Identity(n, n)};
  const Eigen::VectorXd delta = Eigen::VectorXd::Constant(n, 1e-4);
  EXPECT_LT((parameters(StableCoordinates(rig, C.matrix).try_rig(delta)->rig) -
             parameters(retract(rig, delta)))
                .norm(),
            1e-7);
  EXPECT_FALSE(curvature_warning(rig, C));
}

TEST(StableCoordinates, NoDeviationIsTheRigToTheBit) {
  const StableCoordinates about(narrow().rig, narrow().covariance->matrix);
  const auto moved = about.try_rig(Eigen::VectorXd::Zero(16));
  ASSERT_TRUE(moved);
  EXPECT_EQ(parameters(moved->rig), parameters(narrow().rig));
}

TEST(StableCoordinates, FarFromTheMeanTheyAreTheTangent) {
  const StableCoordinates about(narrow().rig, narrow().covariance->matrix);
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(16);
  delta[0] = -2 * narrow().rig.cameras[0].f_px();  // no lens
  EXPECT_FALSE(about.try_rig(delta));
  EXPECT_EQ(parameters(about.rig(delta).rig), parameters(retract(narrow().rig, delta)));
  EXPECT_FALSE(about.try_coordinates(retract(narrow().rig, delta)));
}

TEST(CovarianceCurvature, TellsALinearCovarianceFromOneThatIsNot) {
  EXPECT_LT(covariance_curvature(narrow().rig, *narrow().covariance), largest_curvature);
  EXPECT_FALSE(curvature_warning(narrow().rig, *narrow().covariance));
  const RigEstimate bad = calibrated(rig_with_lens(6000, OpenCv4{}), 7, OpenCv4{});
  EXPECT_GT(covariance_curvature(bad.rig, *bad.covariance), largest_curvature);
  ASSERT_FALSE(bad.calibration->trust_warnings.empty());
  EXPECT_NE(bad.calibration->trust_warnings.back().find("no covariance describes its errors"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
