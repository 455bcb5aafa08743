// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/error.h"
#include "localise/place.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

TEST(Align, FindsAKnownMotion) {
  const auto room = test::random_room(12);
  const Pose2D truth{0.35, -0.2, 0.21};
  const Alignment a = align({test::seen_from(room, truth), {}}, {room, {}});
  EXPECT_LT(distance_m(a.query_in_node, truth), 0.01);
  EXPECT_LT(std::abs(heading_difference_rad(a.query_in_node, truth)), 0.005);
  EXPECT_GT(a.score, 0.7);
}

TEST(Align, AnotherRoomScoresLower) {
  const auto room = test::random_room(12);
  const double same = align({test::seen_from(room, {0.2, 0.1, 0.1}), {}}, {room, {}}).score;
  const double other = align({test::random_room(13), {}}, {room, {}}).score;
  EXPECT_LT(other, 0.6 * same);
}

TEST(Align, FragmentsOfOneLineCountOnce) {
  const auto room = test::random_room(12);
  std::vector<PlaceLine> fragments;
  for (int i = 0; i < 40; ++i) fragments.push_back(room[0]);  // one upright line, over and over
  const double fragmented = align({fragments, {}}, {room, {}}).score;
  EXPECT_LT(fragmented, 0.1);
  EXPECT_LT(align({room, {}}, {room, {}}).score, 1);
}

TEST(Align, NothingInViewScoresZero) {
  EXPECT_EQ(align({}, {test::random_room(1), {}}).score, 0);
  EXPECT_EQ(align({}, {}).score, 0);
}

TEST(Align, BadStepsAreRefused) {
  const auto room = test::random_room(12);
  const auto with = [&](auto... changes) {
    AlignmentOptions options;
    (changes(options), ...);
    return align({room, {}}, {room, {}}, options);
  };
  EXPECT_THROW(with([](AlignmentOptions& o) { o.turn_step_rad = 0; }), Error);
  EXPECT_THROW(with([](AlignmentOptions& o) { o.turn_step_rad = -0.1; }), Error);
  EXPECT_THROW(with([](AlignmentOptions& o) { o.shift_step_m = 0; }), Error);
  EXPECT_THROW(with([](AlignmentOptions& o) { o.shift_step_m = -1; }), Error);
  EXPECT_THROW(with([](AlignmentOptions& o) { o.shift_step_m = 1e-9; }), Error);  // too many
  EXPECT_THROW(with([](AlignmentOptions& o) { o.max_turn_rad = std::nan(""); }), Error);
  EXPECT_THROW(with([](AlignmentOptions& o) { o.position_sigma_m = 0; }), Error);
  EXPECT_NO_THROW(with([](AlignmentOptions& o) { o.max_turn_rad = o.max_shift_m = 0; }));
}

}  // namespace
}  // namespace vernier
