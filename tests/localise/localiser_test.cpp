// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/localiser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

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
TopologicalMap ten_similar_rooms() {
  std::vector<MapNode> nodes;
  for (int i = 0; i < 10; ++i) {
    nodes.push_back({{10.0 * i, 0, 0.3 * i}, {test::random_room(100 + i), {}}});
  }
  return {std::move(nodes)};
}

/// The rankers by histograms put the room itself first.
TEST(HistogramRankers, TheRoomItselfIsFirst) {
  const TopologicalMap map = ten_similar_rooms();
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
  const TopologicalMap map = ten_similar_rooms();
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
  const TopologicalMap map = ten_similar_rooms();
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

/// The map's image lines, and queries that see part of a node's, shifted by noise.
MapNode node_of_random_lines(std::uint64_t seed, std::uint32_t node, int lines) {
  MapNode made{{10.0 * node, 0, 0}, {}};
  for (int k = 0; k < lines; ++k) {
    RandomStream d({.seed = seed, .trial = node, .feature = static_cast<std::uint32_t>(k)});
    const Eigen::Vector2d a{d.uniform(0, 640), d.uniform(0, 480)};
    const Eigen::Vector2d b = a + Eigen::Vector2d{d.uniform(-80, 80), d.uniform(-80, 80)};
    made.view.image_lines.push_back({a, b});
  }
  return made;
}

PlaceView noisy(const PlaceView& view, std::uint64_t seed, double sigma_px) {
  PlaceView seen;
  RandomStream d({.seed = seed});
  for (const auto& line : view.image_lines) {
    const auto end = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
      return x + sigma_px * Eigen::Vector2d{d.normal(), d.normal()};
    };
    if (d.uniform() < 0.8) seen.image_lines.push_back({end(line.a_px), end(line.b_px)});
  }
  return seen;
}

TEST(BaselineLocaliser, FindsAnImageItHasSeen) {
  TopologicalMap map;
  for (int i = 0; i < 6; ++i) map.nodes.push_back(node_of_random_lines(1, i, 25));
  for (const char* method : {"pgh_baseline", "pgh_baseline_vectorised"}) {
    const auto localiser = make_localiser(method, map);
    for (int i = 0; i < 6; ++i) EXPECT_EQ(localiser->localise(map.nodes[i].view).node, i);
  }
}

/// On random maps, from clear queries to such that are hardly like their node, and strangers.
TEST(BaselineLocaliser, VectorisedGivesTheSameAnswers) {
  int answered = 0;
  double farthest = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    TopologicalMap map;
    const auto nodes = static_cast<std::uint32_t>(1 + 3 * seed);
    for (std::uint32_t i = 0; i < nodes; ++i) {
      map.nodes.push_back(node_of_random_lines(seed, i, static_cast<int>((7 * i) % 40)));
    }
    const auto plain = make_localiser("pgh_baseline", map);
    const auto vectorised = make_localiser("pgh_baseline_vectorised", map);
    for (std::uint32_t i = 0; i < nodes + 2; ++i) {
      const PlaceView view = i < nodes ? noisy(map.nodes[i].view, seed, 2.0 * (i % 5))
                                       : node_of_random_lines(seed + 99, i, 20).view;
      const LocalisationAnswer a = plain->localise(view), b = vectorised->localise(view);
      EXPECT_EQ(a.status, b.status);
      EXPECT_EQ(a.node, b.node);
      EXPECT_NEAR(a.score, b.score, 1e-5 * (1 + a.score));
      EXPECT_NEAR(a.runner_up, b.runner_up, 1e-5 * (1 + a.runner_up));
      answered += a.status == LocalisationStatus::answered;
      farthest = std::max(farthest, std::abs(a.score - b.score) / (1 + a.score));
    }
  }
  EXPECT_GT(answered, 100);
  RecordProperty("answered", answered);
  RecordProperty("largest_relative_difference", std::to_string(farthest));
}

/// Of a map without nodes, and of one whose nodes saw nothing.
TEST(Localisers, NothingToMatchIsNoMatch) {
  PlaceView view{test::random_room(100), {}};
  view.image_lines = node_of_random_lines(1, 0, 20).view.image_lines;
  for (const char* method : {"pgh", "pgh_baseline", "pgh_baseline_vectorised"}) {
    for (const std::size_t nodes : {0, 3}) {
      TopologicalMap map;
      map.nodes.resize(nodes);
      const LocalisationAnswer answer = make_localiser(method, map)->localise(view);
      EXPECT_EQ(answer.status, LocalisationStatus::no_match) << method << " " << nodes;
    }
  }
}

TEST(MakeLocaliser, UnknownMethodNamesTheKnown) {
  const TopologicalMap map;
  try {
    make_localiser("sift", map);
    FAIL();
  } catch (const Error& error) {
    const std::string said = error.what();
    EXPECT_EQ(said.find("localiser \"sift\": unknown method; use "), 0u) << said;
    EXPECT_NE(said.find("lines, pgh, pgh_baseline, pgh_baseline_vectorised"), std::string::npos)
        << said;
  }
}

TEST(LocaliserStages, AreNamedInWords) {
  EXPECT_EQ(name(LocaliserStages{}), "align+refine+compare+deepen");
  for (const char* words : {"none", "align", "refine+compare", "align+refine+compare+deepen"}) {
    EXPECT_EQ(name(localiser_stages(words)), words);
  }
  EXPECT_EQ(name(localiser_stages("deepen+align")), "align+deepen");
  for (const char* wrong : {"", "+", "align+", "align+align", "all", "none+align"}) {
    EXPECT_THROW(localiser_stages(wrong), Error) << wrong;
  }
}

}  // namespace
}  // namespace vernier
