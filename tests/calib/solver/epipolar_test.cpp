// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/simulated_pairs.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/epipolar_system.h"
#include "calib/solver/loss.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/resolve_pairs.h"
#include "tests/support/epipolar.h"
#include "tests/support/jet_oracles.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/pair_priors.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

const std::vector<std::string> tested_models{"pinhole", "radial1", "opencv4",
                                             "opencv5", "opencv8", "fisheye4"};

Rig rig_of(const std::string& left, const std::string& right) {
  Rig rig = test::stereo_rig(camera_model(left));
  rig.cameras[1] = test::stereo_rig(camera_model(right)).cameras[1];
  return rig;
}

TEST(Epipolar, ResidualIsTheTextbooksForEveryModel) {
  for (const std::string& name : tested_models) {
    const Rig rig = rig_of(name, name);
    const PairObservations pairs =
        simulate_pairs(rig, 1, 0, {.image_pairs = 3, .pairs_per_image = 9});
    const std::vector<double> r = PackedPairs(pairs).residuals(rig);
    for (std::size_t i = 0; i < r.size(); ++i) {
      EXPECT_NEAR(r[i], test::textbook_sampson(rig, pairs.pixels_px[i], 0.3),
                  2e-7 * (1 + std::abs(r[i])))
          << name << " " << i;
    }
  }
}

TEST(Epipolar, ResidualIsTheBundlesToSecondOrder) {
  const Rig rig = rig_of("opencv4", "opencv4");
  const PairObservations pairs = simulate_pairs(rig, 2);
  const std::vector<double> r = PackedPairs(pairs).residuals(rig);
  for (std::size_t i = 0; i < r.size(); i += 37) {
    const double bundle = test::bundle_distance(rig, pairs.pixels_px[i], 0.3);
    EXPECT_NEAR(std::abs(r[i]), bundle, 1e-3 * (0.01 + bundle)) << i;
  }
}

/// Gradient of one pair's residual from the sums: Σ r J and r.
TEST(Epipolar, GradientWithItsWeightIsTheNumericDerivativeForEveryPairOfModels) {
  for (const std::string& left : tested_models) {
    for (const std::string& right : tested_models) {
      const Rig rig = rig_of(left, right);
      const PairObservations pairs =
          simulate_pairs(rig, 3, 0, {.image_pairs = 4, .pairs_per_image = 1, .pixel_sigma_px = 1});
      const PackedPairs packed(pairs);
      const std::vector<double> r = packed.residuals(rig);
      const Eigen::MatrixXd J = test::numeric_jacobian(
          [&](const Eigen::VectorXd& delta) {
            const std::vector<double> moved = packed.residuals(retract(rig, delta));
            return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(moved.data(), 4));
          },
          Eigen::VectorXd::Zero(parameter_count(rig)), 1e-5);
      for (std::size_t i = 0; i < 4; ++i) {
        const EpipolarSums sums = epipolar_sums(packed, packed.groups()[i], rig, {});
        const Eigen::VectorXd row = J.row(static_cast<Eigen::Index>(i));
        EXPECT_NEAR(sums.cost, r[i] * r[i], 1e-12 * (1 + r[i] * r[i]));
        for (Eigen::Index k = 0; k < row.size(); ++k) {
          EXPECT_NEAR(sums.gradient[k], r[i] * row[k],
                      1e-6 * std::abs(r[i]) * (1 + std::abs(row[k])))
              << left << " " << right << " pair " << i << " " << parameter_names(rig)[k];
        }
        EXPECT_TRUE(sums.information.isApprox(row * row.transpose(), 1e-5)) << left << right;
      }
    }
  }
}

TEST(Epipolar, SumsAreTheSumsOfThePairs) {
  const Rig rig = rig_of("radial1", "opencv5");
  const PairObservations pairs =
      simulate_pairs(rig, 4, 0, {.image_pairs = 7, .pairs_per_image = 61});
  const PackedPairs packed(pairs);
  const std::vector<double> r = packed.residuals(rig);
  for (const Loss loss : {Loss{}, Loss{LossShape::huber, 1.0}, Loss{LossShape::tukey, 2.0}}) {
    const EpipolarSums all = epipolar_sums(packed, rig, loss);
    double cost = 0;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(all.gradient.size());
    for (const PackedPairs::Group& group : packed.groups()) {
      const EpipolarSums one = epipolar_sums(packed, group, rig, loss);
      gradient += one.gradient;
      for (std::size_t i = group.row; i < group.row + group.count; ++i) {
        cost += cost_of(loss, r[i]);
      }
    }
    EXPECT_NEAR(all.cost, cost, 1e-10 * cost);
    EXPECT_LT((all.gradient - gradient).norm(), 1e-9 * gradient.norm());
    const auto cost_there = [&](const Eigen::VectorXd& delta) {
      return Eigen::VectorXd::Constant(1,
                                       0.5 * epipolar_sums(packed, retract(rig, delta), loss).cost);
    };
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(parameter_count(rig));
    const Eigen::VectorXd numeric = test::numeric_jacobian(cost_there, zero, 1e-6).row(0);
    for (Eigen::Index k = 0; k < zero.size(); ++k) {
      EXPECT_NEAR(numeric[k], all.gradient[k], 1e-3 * (1 + std::abs(all.gradient[k]))) << k;
    }
  }
}

TEST(Epipolar, ResolverFindsTheTruthWithoutNoise) {
  const Rig truth = rig_of("radial1", "radial1");
  const PairObservations pairs = simulate_pairs(truth, 6, 0, {.pixel_sigma_px = 0});
  const auto n = parameter_count(truth);
  const Eigen::VectorXd sd = test::datasheet_sd();
  const RigPrior prior{truth, Eigen::MatrixXd(sd.cwiseAbs2().cwiseInverse().asDiagonal())};
  Eigen::VectorXd away(n);
  away << 5, -0.001, 4, -6, 0.01, -7, 0.001, 3, 2, -0.01, 0.003, -0.004, 0.002, 0.001, 0.001,
      -0.001;
  const EpipolarMinimum found =
      PairResolver(pairs).minimise(retract(truth, away), {.priors = {prior}});
  EXPECT_TRUE(found.converged);
  EXPECT_LT(found.iterations, 15);
  EXPECT_LT(difference(found.rig, truth).cwiseQuotient(sd).norm(), 1e-6);
  EXPECT_LT(found.cost, 1e-10);
}

/// Against Ceres with the textbook's formulas differentiated automatically.
TEST(Epipolar, ResolverEndsWhereCeresDoes) {
  const Rig truth = rig_of("radial1", "radial1");
  const PairObservations pairs = simulate_pairs(truth, 7);
  const RigPrior prior{truth, test::datasheet_sd().cwiseAbs2().cwiseInverse().asDiagonal()};
  const EpipolarMinimum ours = PairResolver(pairs).minimise(truth, {.priors = {prior}});
  const Rig theirs = test::solve_by_jets(pairs, prior, truth);
  const Eigen::MatrixXd E = free_directions(truth, std::vector<bool>(16, false));
  const EpipolarSystem system =
      epipolar_system(PackedPairs(pairs), ours.rig, {.priors = {prior}}, E);
  const Eigen::VectorXd d = difference(theirs, ours.rig);
  EXPECT_LT(std::sqrt(d.dot(system.information * d)), 1e-6);
}

TEST(Epipolar, BalancedLossesHaveTheMeanCurvatureOfTheSquare) {
  for (const Loss& loss : {balanced(LossShape::huber, 1.345), balanced(LossShape::tukey, 5),
                           balanced(LossShape::tukey, 3)}) {
    double mean = 0;  // of ρ''/2 by the trapezium rule over the normal density
    const double h = 1e-3;
    for (double z = -9; z < 9; z += h) {
      const double bend =
          (weight_of(loss, z + h / 2) * (z + h / 2) - weight_of(loss, z - h / 2) * (z - h / 2)) / h;
      mean += h * bend * std::exp(-z * z / 2) / std::sqrt(2 * std::acos(-1.0));
    }
    EXPECT_NEAR(mean, 1, 1e-5);
  }
}

}  // namespace
}  // namespace vernier
