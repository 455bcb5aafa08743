// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/localiser.h"

#include <gtest/gtest.h>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

/// Ten rooms side by side, 10 m apart.
TopologicalMap ten_rooms() {
  std::vector<MapNode> nodes;
  for (int i = 0; i < 10; ++i) {
    nodes.push_back({{10.0 * i, 0, 0.3 * i}, {test::random_room(100 + i), {}}});
  }
  return {std::move(nodes)};
}

/// The rankers by histograms put the room itself first.
TEST(HistogramRankers, TheRoomItselfIsFirst) {
  const TopologicalMap map = ten_rooms();
  for (const char* name : {"pgh", "pgh_aggregate"}) {
    const auto ranker = make_ranker(name, map, {});
    for (int i = 0; i < 10; ++i) {
      const auto ranked =
          ranker->rank({test::seen_from(test::random_room(100 + i), {0.2, 0.1, 0.2}), {}}, 3);
      ASSERT_EQ(ranked.size(), 3u);
      EXPECT_EQ(ranked[0].node, i) << name;
      EXPECT_GT(ranked[0].score, ranked[1].score);
      EXPECT_LE(ranked[0].score, 1 + 1e-5);
    }
  }
}

TEST(PghLocaliser, AnswersWithNodeAndMetricPose) {
  const TopologicalMap map = ten_rooms();
  const auto localiser = make_localiser("pgh", map);
  const Pose2D step{0.3, -0.2, 0.15};
  const LocalisationAnswer answer =
      localiser->localise({test::seen_from(test::random_room(107), step), {}});
  EXPECT_EQ(answer.status, LocalisationStatus::answered);
  EXPECT_EQ(answer.node, 7);
  EXPECT_LT(distance_m(answer.pose, compose(map.nodes[7].pose, step)), 0.02);
  EXPECT_GT(answer.score, answer.runner_up);
}

TEST(PghLocaliser, AbstainsWithTooFewLines) {
  const TopologicalMap map = ten_rooms();
  const LocalisationAnswer answer =
      make_localiser("pgh", map)->localise({test::random_room(100, 3), {}});
  EXPECT_EQ(answer.status, LocalisationStatus::too_few_lines);
  EXPECT_EQ(answer.node, -1);
}

TEST(PghLocaliser, AbstainsWhereTwoPlacesAreTheSame) {
  std::vector<MapNode> nodes;
  for (int i = 0; i < 4; ++i) nodes.push_back({{10.0 * i, 0, 0}, {test::random_room(100), {}}});
  const TopologicalMap map{std::move(nodes)};
  const LocalisationAnswer answer =
      make_localiser("pgh", map)->localise({test::random_room(100), {}});
  EXPECT_EQ(answer.status, LocalisationStatus::tie);
}

TEST(BaselineLocaliser, FindsAnImageItHasSeen) {
  std::vector<MapNode> nodes;
  for (int i = 0; i < 6; ++i) {
    MapNode node{{10.0 * i, 0, 0}, {}};
    for (int k = 0; k < 25; ++k) {
      RandomStream d(
          {.seed = static_cast<std::uint64_t>(i), .feature = static_cast<std::uint32_t>(k)});
      const Eigen::Vector2d a(d.uniform(0, 640), d.uniform(0, 480));
      node.view.image_lines.push_back(
          {a, a + Eigen::Vector2d(d.uniform(-80, 80), d.uniform(-80, 80))});
    }
    nodes.push_back(node);
  }
  const TopologicalMap map{nodes};
  const auto localiser = make_localiser("pgh_baseline", map);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(localiser->localise(map.nodes[i].view).node, i);
}

TEST(MakeLocaliser, UnknownMethodNamesTheKnown) {
  const TopologicalMap map;
  try {
    make_localiser("sift", map);
    FAIL();
  } catch (const Error& error) {
    const std::string said = error.what();
    EXPECT_EQ(said.find("localiser \"sift\": unknown method; use "), 0u) << said;
    EXPECT_NE(said.find("lines, pgh or pgh_baseline"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace vernier
