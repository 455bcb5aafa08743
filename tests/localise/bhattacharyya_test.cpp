// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/bhattacharyya.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/error.h"
#include "calib/statistics/random.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;

namespace {

Eigen::VectorXd random_histogram(std::uint64_t seed, int bins) {
  Eigen::VectorXd h(bins);
  RandomStream d({.seed = seed});
  for (int i = 0; i < bins; ++i) h[i] = d.uniform() < 0.2 ? 0 : d.uniform();
  return h / h.sum();
}

TEST(Bhattacharyya, IsTheSumOfRootsAndIgnoresScale) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Eigen::VectorXd p = random_histogram(seed, 30), q = random_histogram(seed + 100, 30);
    double sum = 0;
    for (int i = 0; i < 30; ++i) sum += std::sqrt(p[i] * q[i]);
    EXPECT_NEAR(bhattacharyya_coefficient(p, q), sum, 1e-14);
    EXPECT_NEAR(bhattacharyya_coefficient(7 * p, 1e-200 * q), sum, 1e-14);
    EXPECT_NEAR(bhattacharyya_coefficient(p, p), 1, 1e-14);
    EXPECT_LE(bhattacharyya_coefficient(p, 1e300 * p), 1);
  }
}

TEST(Bhattacharyya, IsZeroWithoutCommonBins) {
  EXPECT_EQ(bhattacharyya_coefficient(Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)), 0);
  EXPECT_EQ(bhattacharyya_coefficient(Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 0)), 0);
  EXPECT_EQ(bhattacharyya_coefficient(Eigen::VectorXd(0), Eigen::VectorXd(0)), 0);
}

TEST(Bhattacharyya, WhatIsNoHistogramIsRefused) {
  const Eigen::Vector2d good(1, 2);
  EXPECT_THROW(bhattacharyya_coefficient(good, Eigen::Vector3d(1, 2, 3)), Error);
  EXPECT_THROW(bhattacharyya_coefficient(good, Eigen::Vector2d(1, -1e-9)), Error);
  EXPECT_THROW(bhattacharyya_coefficient(Eigen::Vector2d(1, std::nan("")), good), Error);
  EXPECT_THROW(expected_coefficient(0, 5, 5), Error);
  EXPECT_THROW(expected_coefficient(3, 5, 0), Error);
}

TEST(Bhattacharyya, DistancesAreThoseOfTheRoots) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Eigen::VectorXd p = random_histogram(seed, 30), q = random_histogram(seed + 100, 30);
    const double b = bhattacharyya_coefficient(p, q);
    const double between_roots = (p.cwiseSqrt() - q.cwiseSqrt()).norm();
    EXPECT_NEAR(matusita_distance(b), between_roots, 1e-14);
    EXPECT_NEAR(hellinger_distance(b), between_roots / std::sqrt(2), 1e-14);
    EXPECT_NEAR(std::exp(-bhattacharyya_distance(b)), b, 1e-14);
  }
  EXPECT_EQ(hellinger_distance(1 + 1e-15), 0);
  EXPECT_EQ(matusita_distance(1 + 1e-15), 0);
  EXPECT_EQ(bhattacharyya_distance(1 + 1e-15), 0);
  EXPECT_EQ(hellinger_distance(0), 1);
  EXPECT_TRUE(std::isinf(bhattacharyya_distance(0)));
}

/// Hellinger's and Matusita's are metrics; -ln B is not.
TEST(Bhattacharyya, TriangleInequality) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Eigen::VectorXd p = random_histogram(seed, 5), q = random_histogram(seed + 1000, 5),
                          r = random_histogram(seed + 2000, 5);
    const double pq = bhattacharyya_coefficient(p, q), qr = bhattacharyya_coefficient(q, r),
                 pr = bhattacharyya_coefficient(p, r);
    EXPECT_LE(hellinger_distance(pr), hellinger_distance(pq) + hellinger_distance(qr) + 1e-12);
    EXPECT_LE(matusita_distance(pr), matusita_distance(pq) + matusita_distance(qr) + 1e-12);
  }
  const Eigen::Vector2d p(1, 0), q(0.5, 0.5), r(0, 1);
  EXPECT_GT(bhattacharyya_distance(bhattacharyya_coefficient(p, r)),
            bhattacharyya_distance(bhattacharyya_coefficient(p, q)) +
                bhattacharyya_distance(bhattacharyya_coefficient(q, r)));
}

/// Histograms of counts drawn from one distribution.
TEST(ExpectedCoefficient, IsTheMeanOverTrials) {
  struct Case {
    int bins, n_p, n_q;
  };
  for (const Case& c : {Case{4, 200, 200}, Case{20, 800, 400}, Case{60, 3000, 6000}}) {
    const int bins = c.bins;
    // Uneven, with at least half of the even share in each bin.
    const Eigen::VectorXd p = 0.5 * random_histogram(static_cast<std::uint64_t>(bins), bins) +
                              Eigen::VectorXd::Constant(bins, 0.5 / bins);
    RandomStream d({.seed = 11, .feature = static_cast<std::uint32_t>(bins)});
    const auto counts = [&](int n) {
      Eigen::VectorXd h = Eigen::VectorXd::Zero(bins);
      for (int i = 0; i < n; ++i) {
        double left = d.uniform();
        int bin = 0;
        while (bin + 1 < bins && left > p[bin]) left -= p[bin++];
        ++h[bin];
      }
      return h;
    };
    const int trials = 2000;
    double sum = 0, squares = 0;
    for (int i = 0; i < trials; ++i) {
      const Eigen::VectorXd one = counts(c.n_p), other = counts(c.n_q);
      const double b = bhattacharyya_coefficient(one, other);
      sum += b;
      squares += b * b;
    }
    const double mean = sum / trials;
    const double error = std::sqrt((squares / trials - mean * mean) / trials);
    const double expected = expected_coefficient(bins, c.n_p, c.n_q);
    // Sampling error, and the next order: a twentieth of what counts cost.
    EXPECT_NEAR(mean, expected, 4 * error + 0.05 * (1 - expected)) << bins;
    RecordProperty("bins_" + std::to_string(bins) + "_cost_ratio",
                   std::to_string((1 - mean) / (1 - expected)));
  }
}

}  // namespace
}  // namespace vernier
