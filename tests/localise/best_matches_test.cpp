// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/histograms/best_matches.h"

#include <gtest/gtest.h>

#include "calib/base/instruction_set.h"
#include "calib/error.h"
#include "calib/statistics/random.h"
#include "localise/pgh.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

HistogramRows random_rows(std::uint64_t seed, int rows, int columns) {
  HistogramRows H(rows, columns);
  RandomStream d({.seed = seed});
  for (Eigen::Index i = 0; i < H.size(); ++i) H.data()[i] = static_cast<float>(d.uniform());
  for (int r = 0; r < rows; ++r) H.row(r).normalize();
  return H;
}

class Sizes : public testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(Sizes, AgreesWithThePlainProduct) {
  const auto [q, s, n] = GetParam();
  const HistogramRows Q = random_rows(1, q, n), S = random_rows(2, s, n);
  const Eigen::MatrixXf G = Q * S.transpose();
  const BestMatches best = best_matches(Q, S);
  EXPECT_LT((best.of_queries - G.rowwise().maxCoeff()).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((best.of_stored - G.colwise().maxCoeff().transpose()).cwiseAbs().maxCoeff(), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Shapes,
                         Sizes,
                         testing::Values(std::tuple(1, 1, 1),
                                         std::tuple(4, 2, 16),
                                         std::tuple(5, 3, 17),
                                         std::tuple(100, 71, 720),
                                         std::tuple(3, 101, 719)));

TEST(BestMatches, EmptyPartnersGiveZeros) {
  const HistogramRows Q = random_rows(1, 3, 8), none(0, 8);
  EXPECT_EQ(best_matches(Q, none).of_queries, Eigen::VectorXf::Zero(3));
  EXPECT_EQ(best_matches(none, Q).of_stored, Eigen::VectorXf::Zero(3));
}

TEST(BestMatches, DifferentBinsAreRefused) {
  EXPECT_THROW(best_matches(random_rows(1, 3, 8), random_rows(1, 3, 9)), Error);
}

TEST(BestMatches, NamesItsInstructionSet) { EXPECT_FALSE(instruction_set().empty()); }

}  // namespace
}  // namespace vernier
