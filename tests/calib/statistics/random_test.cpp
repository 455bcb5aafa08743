// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "calib/error.h"

namespace vernier {

using namespace vernier::internal;

namespace {

TEST(RandomStream, SamePlaceSameNumbers) {
  const RandomCounter place{
      .seed = 7, .trial = 3, .feature = 11, .source = 2, .eye = 1, .frame = 5};
  RandomStream a(place), b(place);
  for (int i = 0; i < 9; ++i) {
    const double drawn = a.uniform();
    EXPECT_EQ(drawn, b.uniform());
  }
}

TEST(RandomStream, EveryPartOfThePlaceMatters) {
  const RandomCounter places[] = {{},           {.seed = 1},    {.seed = 1ull << 32},
                                  {.trial = 1}, {.feature = 1}, {.source = 1},
                                  {.eye = 1},   {.frame = 1}};
  std::set<double> firsts;
  for (const auto& place : places) firsts.insert(RandomStream(place).uniform());
  EXPECT_EQ(firsts.size(), std::size(places));
}

TEST(RandomStream, RefusesFieldsBeyondTheirBits) {
  EXPECT_THROW(RandomStream({.source = 256}), Error);
  EXPECT_THROW(RandomStream({.eye = 4}), Error);
  EXPECT_THROW(RandomStream({.frame = 1u << 22}), Error);
}

TEST(RandomCounter, OfViewsDiffersForAllFramesAndCameras) {
  EXPECT_EQ(of_view({.seed = 5}, 3, 1).feature, 193u);
  EXPECT_EQ(of_view({.seed = 5}, 3, 1).frame, 0u);
  constexpr int largest = std::numeric_limits<int>::max();
  std::set<double> firsts;
  for (const int frame : {0, 1, 1 << 25, 1 << 26, (1 << 26) + 1, largest - (1 << 26), largest,
                          67107840, (1 << 26) - 1}) {
    for (const int camera : {0, 1, 63}) {
      firsts.insert(RandomStream(of_view({.seed = 5}, frame, camera)).uniform());
    }
  }
  EXPECT_EQ(firsts.size(), 27u);
  for (const std::uint32_t prior : {0u, 1u, 63u, 65535u}) {  // 0: camera 0 of frame 67107840
    firsts.insert(RandomStream(of_prior({.seed = 5}, prior)).uniform());
  }
  EXPECT_EQ(firsts.size(), 31u);
  // Priors drew there before views did so everywhere.
  EXPECT_EQ(of_prior({.seed = 5}, 2).feature, 0xffff0002u);
}

TEST(NormalQuantile, InvertsTheDistribution) {
  for (const double z : {-8.0, -5.5, -3.0, -1.0, -0.1, 0.0, 0.4, 1.7, 2.6, 4.9}) {
    const double p = 0.5 * std::erfc(-z / std::sqrt(2.0));
    EXPECT_NEAR(normal_quantile(p), z, 2e-12 * std::max(1.0, std::exp(z > 0 ? z * z / 2 : 0)));
  }
}

// The published example of Random123 for Philox4x32-10 with zero counter and key.
TEST(RandomStream, IsPhilox) {
  RandomStream draws(RandomCounter{});
  const std::uint64_t first = (0xe169c58dull << 32 | 0x6627e8d5ull) >> 11;
  EXPECT_EQ(draws.uniform(), (static_cast<double>(first) + 0.5) * 0x1p-53);
}

}  // namespace
}  // namespace vernier
