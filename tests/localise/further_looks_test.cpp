// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "tests/support/camera_views.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::localise;

namespace {

using test::camera_view;
using test::full_room;

/// Two rooms alike ahead, and different to the left.
TopologicalMap map_of_twins() {
  TopologicalMap map;
  for (int i = 0; i < 2; ++i) {
    map.nodes.push_back({{20.0 * i, 0, 0}, camera_view(full_room(7))});
    map.nodes.push_back({{20.0 * i, 0, std::numbers::pi / 2}, camera_view(full_room(70 + i))});
  }
  return map;
}

TEST(LineLocaliser, IsUnsureBetweenTwinsAndSaysWhereToLook) {
  const TopologicalMap map = map_of_twins();
  const auto localiser = make_localiser("lines", map);
  const LocalisationAnswer answer = localiser->localise(map.nodes[0].view);
  EXPECT_EQ(answer.status, LocalisationStatus::unsure);
  EXPECT_NEAR(answer.probability, 0.5, 0.1);
  ASSERT_GE(answer.modes.size(), 2u);
  EXPECT_NEAR(answer.next_turn_rad, std::numbers::pi / 2, 0.6);

  for (int i = 0; i < 2; ++i) {
    const std::vector<Look> looks{{map.nodes[0].view, 0},
                                  {map.nodes[2 * i + 1].view, std::numbers::pi / 2}};
    const LocalisationAnswer sure = localiser->localise_looks(looks);
    EXPECT_EQ(sure.status, LocalisationStatus::answered);
    EXPECT_LT(distance_m(sure.pose, {20.0 * i, 0, 0}), 0.02);
    EXPECT_LT(std::abs(heading_difference_rad(sure.pose, {})), 0.01);
  }
}

// How sure an answer has to be, and how sure one that needs no further look, are two questions.
TEST(LineLocaliser, AnswersAndAsksForALookWhereBothAreWanted) {
  const TopologicalMap map = map_of_twins();
  LocaliserOptions options;
  options.max_error_rate = 0.7;
  const LocalisationAnswer plain =
      make_localiser("lines", map, options)->localise(map.nodes[0].view);
  EXPECT_EQ(plain.status, LocalisationStatus::answered);
  EXPECT_EQ(plain.next_turn_rad, 0);

  options.look_error_rate = 0.01;
  const auto localiser = make_localiser("lines", map, options);
  const LocalisationAnswer answer = localiser->localise(map.nodes[0].view);
  EXPECT_EQ(answer.status, LocalisationStatus::answered);
  EXPECT_NEAR(answer.next_turn_rad, std::numbers::pi / 2, 0.6);
  const std::vector<Look> looks{{map.nodes[0].view, 0}, {map.nodes[1].view, std::numbers::pi / 2}};
  EXPECT_EQ(localiser->localise_looks(looks).next_turn_rad, 0);  // sure

  for (const double wrong : {0.0, -0.1, 0.71, std::numeric_limits<double>::quiet_NaN()}) {
    options.look_error_rate = wrong;
    EXPECT_THROW(make_localiser("lines", map, options), Error) << wrong;
  }
  options.look_error_rate = 1e-9;  // less than can be stated in any map
  EXPECT_THROW(make_localiser("lines", map, options), Error);
}

// The list was in the order of before it was counted how much of each mode lies within 1 m: the
// answer was another mode than the most probable one in a tenth of such queries.
TEST(LineLocaliser, ModesComeByTheirProbability) {
  const TopologicalMap map = map_of_twins();
  LocaliserOptions options;
  options.max_error_rate = 1;
  const auto localiser = make_localiser("lines", map, options);
  int several = 0;
  for (std::size_t first = 0; first + 4 < map.nodes[0].view.lines.size(); ++first) {
    PlaceView few = map.nodes[0].view;
    few.lines.erase(few.lines.begin() + first + 4, few.lines.end());
    few.lines.erase(few.lines.begin(), few.lines.begin() + first);
    const LocalisationAnswer answer = localiser->localise(few);
    if (answer.modes.empty()) continue;
    several += answer.modes.size() > 1;
    EXPECT_TRUE(
        std::is_sorted(answer.modes.begin(), answer.modes.end(),
                       [](const auto& a, const auto& b) { return a.probability > b.probability; }))
        << first;
    EXPECT_EQ(answer.probability, answer.modes[0].probability);
    EXPECT_EQ(distance_m(answer.pose, answer.modes[0].pose), 0);
    EXPECT_TRUE(answer.states_probability());
  }
  EXPECT_GT(several, 20);
}

// Parallel level lines fit all along them: what such a mode has within 1 m counts for it, however
// little that is, and it does not stand before one that is as probable and known.
TEST(LineLocaliser, ModesAlongParallelLinesAreNotSure) {
  const TopologicalMap map = map_of_twins();
  LocaliserOptions options;
  options.max_error_rate = 1;
  const auto localiser = make_localiser("lines", map, options);
  PlaceView parallel = map.nodes[0].view;
  parallel.lines.clear();
  for (int i = 0; i < 6; ++i) {
    parallel.lines.push_back({{3, 2.0 - i, 0.3 * i}, {3, 1.5 - i, 0.3 * i}, LineKind::level, 0.01});
  }
  const LocalisationAnswer answer = localiser->localise(parallel);
  for (const PoseMode& mode : answer.modes) {
    EXPECT_LE(mode.probability, answer.probability);
    EXPECT_GT(mode.probability, 0);
  }
  EXPECT_LT(answer.probability, 0.9);
}

// A look at a wall asked for nothing, and was followed by one to what a map along a path has not
// recorded: of offices of seeds 1 to 20, one such pose was found wrongly in 19.
TEST(LineLocaliser, AViewOfFewLinesAsksForATurnThatTheMapHolds) {
  const TopologicalMap map = map_of_twins();
  const auto localiser = make_localiser("lines", map);
  for (const std::size_t lines : {0, 2}) {
    PlaceView few = map.nodes[0].view;
    few.lines.resize(lines);
    const LocalisationAnswer answer = localiser->localise(few);
    EXPECT_EQ(answer.status, LocalisationStatus::too_few_lines) << lines;
    EXPECT_EQ(answer.node, -1);
    EXPECT_NEAR(answer.next_turn_rad, std::numbers::pi / 2, 0.6) << lines;
  }
}

}  // namespace

}  // namespace vernier
