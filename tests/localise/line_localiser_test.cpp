// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include "calib/statistics/random.h"
#include "datasets/shipped.h"
#include "localise/localiser.h"
#include "localise/map/known_lines.h"
#include "localise/map/merged_lines.h"
#include "localise/map/node_grid.h"
#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/ranking/panorama.h"
#include "localise/verification/floor_plan_votes.h"
#include "tests/support/camera_views.h"
#include "tests/support/error_message.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

using test::camera_view;
using test::full_room;
using test::view_of;

/// Ten rooms side by side, 20 m apart, each seen from its middle.
TopologicalMap map_of_rooms(int rooms) {
  TopologicalMap map;
  for (int i = 0; i < rooms; ++i) {
    map.nodes.push_back({{20.0 * i, 0, 0.3 * i}, camera_view(full_room(100 + i))});
  }
  return map;
}

TEST(FloorPlanVotes, FindTheMotion) {
  const std::vector<PlaceLine> room = test::random_room(4, 90);
  const Pose2D truth{0.3, -0.4, 0.1};
  const auto query = plan_uprights(test::seen_from(room, truth));
  const auto peaks = vote(query, plan_uprights(room), {0.2, -0.1, 0.05});
  ASSERT_FALSE(peaks.empty());
  EXPECT_LT(distance_m(peaks[0].query_in_node, truth), 0.12);
  EXPECT_LT(std::abs(heading_difference_rad(peaks[0].query_in_node, truth)), 0.05);
  for (std::size_t i = 1; i < peaks.size(); ++i) EXPECT_LE(peaks[i].votes, peaks[i - 1].votes);
  EXPECT_TRUE(vote({}, plan_uprights(room), {}).empty());
}

TEST(FloorPlanVotes, ALineVotesOnceForACell) {
  const PlanUpright one{2, 0, 0, 2, 0};
  const std::vector<PlanUpright> many(50, one);
  const auto single = vote({&one, 1}, {&one, 1}, {});
  const auto crowd = vote({&one, 1}, many, {});
  ASSERT_FALSE(single.empty());
  EXPECT_FLOAT_EQ(single[0].votes, crowd[0].votes);
}

// A ranking, whose first five are compared in full: of 40 rooms, 39 were among them, and 28 first.
TEST(Panorama, FindsHeadingAndPlace) {
  constexpr int rooms = 40;
  const TopologicalMap map = map_of_rooms(rooms);
  const auto ranker = make_ranker("view", map, {});
  int first = 0, among_five = 0;
  for (int i = 0; i < rooms; ++i) {
    const Pose2D step{0.1, 0.1, 0.15};
    const auto ranked = ranker->rank(camera_view(full_room(100 + i), step), 5);
    const auto right = std::ranges::find_if(ranked, [&](const auto& one) { return one.node == i; });
    if (right == ranked.end()) continue;
    ++among_five;
    first += right == ranked.begin();
    EXPECT_LT(distance_m(right->query_in_node, step), 0.6) << i;  // they lie 0.4 m apart
    EXPECT_LT(std::abs(heading_difference_rad(right->query_in_node, step)), 0.3) << i;
  }
  EXPECT_GE(among_five, 36);
  EXPECT_GE(first, 22);
}

// Property: with views all around, the heading of a query turns its match by as much.
TEST(Panorama, KnowsAllHeadings) {
  TopologicalMap map;
  std::vector<PlaceLine> around;
  for (int k = 0; k < 4; ++k) {
    const auto part = test::random_room(200 + k, 60);
    for (const PlaceLine& line : test::seen_from(part, {0, 0, -0.5 * std::numbers::pi * k})) {
      around.push_back(line);
    }
  }
  for (int k = 0; k < 8; ++k) {
    const Pose2D pose{0, 0, 0.25 * std::numbers::pi * k};
    std::vector<PlaceLine> seen;
    for (const PlaceLine& line : test::seen_from(around, pose)) {
      const Eigen::Vector3d m = 0.5 * (line.a_m + line.b_m);
      if (std::abs(std::atan2(m.y(), m.x())) < 0.54) seen.push_back(line);
    }
    map.nodes.push_back({pose, view_of(seen)});
  }
  const auto ranker = make_ranker("view", map, {});
  for (const double heading : {0.2, 1.3, 2.9, -1.9, -0.4}) {
    std::vector<PlaceLine> seen;
    for (const PlaceLine& line : test::seen_from(around, {0, 0, heading})) {
      const Eigen::Vector3d m = 0.5 * (line.a_m + line.b_m);
      if (std::abs(std::atan2(m.y(), m.x())) < 0.54) seen.push_back(line);
    }
    const auto ranked = ranker->rank(view_of(seen), 1);
    ASSERT_EQ(ranked.size(), 1u);
    const Pose2D pose = compose(map.nodes[ranked[0].node].pose, ranked[0].query_in_node);
    EXPECT_LT(std::abs(heading_difference_rad(pose, {0, 0, heading})), 0.12) << heading;
  }
}

TEST(NodeGrid, IsASearchOfAllNodes) {
  TopologicalMap map;
  RandomStream d({.seed = 9});
  for (int i = 0; i < 400; ++i) {
    map.nodes.push_back({{d.uniform(-15, 15), d.uniform(-9, 9), d.uniform(-3, 3)}, {}});
  }
  const NodeGrid grid(map);
  for (int i = 0; i < 50; ++i) {
    const Pose2D at{d.uniform(-16, 16), d.uniform(-10, 10), d.uniform(-3, 3)};
    std::vector<int> expected;
    for (int k = 0; k < 400; ++k) {
      const Pose2D& pose = map.nodes[k].pose;
      if (distance_m(pose, at) <= 1.7 && std::abs(heading_difference_rad(pose, at)) <= 1.2) {
        expected.push_back(k);
      }
    }
    EXPECT_EQ(grid.near(at, 1.7, 1.2), expected);
  }
}

TEST(NodeGrid, FindsNodesAcrossCellBorders) {
  TopologicalMap map;
  map.nodes = {{{-0.1, 0, 0}, {}}, {{0.3, 0, 0}, {}}, {{2.1, 0, 0}, {}}};
  const NodeGrid grid(map);
  EXPECT_EQ(grid.near({-6.1e-17, 0, 0}, 1.1, 1), (std::vector<int>{0, 1}));
  EXPECT_EQ(grid.near({1.9999999999999998, 0, 0}, 2, 1), (std::vector<int>{1, 2}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(grid.near({nan, 0, 0}, 1, 1).empty());
  EXPECT_TRUE(grid.near({1e300, 0, 0}, 1, 1).empty());
  map.nodes[1].pose.heading_rad = 1e308;
  EXPECT_EQ(test::error_message([&] { make_localiser("lines", map); }),
            "map node 1: its pose is not finite or beyond 1e6; leave the node out");
}

// Oracle: the rule of KnownLines in double precision, line by line.
TEST(KnownLines, AgreeWithTheRule) {
  const auto first = test::random_room(31, 60);
  auto second = test::random_room(31, 60);
  RandomStream d({.seed = 3});
  for (PlaceLine& line : second) {
    const Eigen::Vector3d u = (line.b_m - line.a_m).normalized();
    line.a_m += d.uniform(-0.4, 0.4) * u;
    line.a_m.y() += d.uniform(-0.1, 0.1);
    line.b_m += Eigen::Vector3d(0, d.uniform(-0.1, 0.1), 0);
  }
  KnownLines known;
  for (const PlaceLine& line : first) {
    known.add(line.a_m.cast<float>(), line.b_m.cast<float>(), static_cast<float>(line.sigma_m));
  }
  int contained = 0;
  for (const PlaceLine& line : second) {
    const double length = line.length_m(), excess = 0.15 * length + 0.1;
    const Eigen::Vector3d u = (line.b_m - line.a_m) / length, m = 0.5 * (line.a_m + line.b_m);
    bool expected = false;
    for (const PlaceLine& k : first) {
      const Eigen::Vector3d v = (k.b_m - k.a_m).normalized(), r = m - k.a_m;
      const double along = r.dot(v), aside = 0.05 + 0.25 * (k.sigma_m + line.sigma_m);
      expected |= std::abs(u.dot(v)) >= 0.985 && along >= 0.5 * length - excess &&
                  along <= k.length_m() + excess - 0.5 * length && (r - along * v).norm() < aside;
    }
    EXPECT_EQ(known.contain(line.a_m.cast<float>(), line.b_m.cast<float>(),
                            static_cast<float>(line.sigma_m)),
              expected);
    contained += expected;
  }
  EXPECT_GT(contained, 10);
  EXPECT_LT(contained, 50);
}

TEST(MergedLines, AddsWhatNeighboursSeeOnce) {
  TopologicalMap map;
  const auto room = test::random_room(12, 40), more = test::random_room(13, 10);
  auto seen = test::seen_from(room, {0.5, 0, 0});
  for (const PlaceLine& line : test::seen_from(more, {0.5, 0, 0})) seen.push_back(line);
  map.nodes = {
      {{0, 0, 0}, view_of(room)}, {{0.5, 0, 0}, view_of(seen)}, {{9, 0, 0}, view_of(room)}};
  const SpaceLines merged = merged_lines(map, NodeGrid(map), 0);
  EXPECT_GE(merged.size, 45u);
  EXPECT_LE(merged.size, 50u);
  for (std::size_t i = 0; i < merged.size; ++i) {
    EXPECT_EQ(merged.counted[i], i < 40 ? 1.0f : 0.0f);
  }
  const Eigen::Vector3f a = more[9].a_m.cast<float>();
  EXPECT_LT((merged.a_m(merged.size - 1) - a).norm(), 1e-5);
}

/// One upright 2 m ahead, given often, as no detector would.
PlaceView one_upright(const TopologicalMap& map, int times, double jitter_m) {
  PlaceView view;
  view.rig = map.nodes[0].view.rig;
  RandomStream d({.seed = 5});
  for (int i = 0; i < times; ++i) {
    const Eigen::Vector3d off{jitter_m * d.normal(), jitter_m * d.normal(), 0};
    view.lines.push_back({Eigen::Vector3d(2, 0.5, 0) + off, Eigen::Vector3d(2, 0.5, 1.5) + off,
                          LineKind::vertical, 0.01});
  }
  return view;
}

// A line fits a circle of poses, however often it is given.
TEST(LineLocaliser, IsNotSureOfOneLine) {
  const TopologicalMap map = map_of_rooms(10);
  const auto localiser = make_localiser("lines", map, {});
  for (const int times : {1, 3, 12, 20, 60, 300}) {
    EXPECT_NE(localiser->localise(one_upright(map, times, 0)).status, LocalisationStatus::answered)
        << times;
  }
  // A centimetre apart they are lines of their own, whose number alone is no proof either.
  for (const int times : {3, 12, 20, 60}) {
    EXPECT_NE(localiser->localise(one_upright(map, times, 0.01)).status,
              LocalisationStatus::answered)
        << times;
  }
  PlaceView two = one_upright(map, 60, 0);
  for (int i = 0; i < 60; ++i) {
    two.lines.push_back({{3, -0.5, 0}, {3, -0.5, 1.5}, LineKind::vertical, 0.01});
  }
  EXPECT_NE(localiser->localise(two).status, LocalisationStatus::answered);
}

TEST(LineLocaliser, RefusesAnErrorRateThatCannotBeStated) {
  LocaliserOptions options;
  options.max_error_rate = 1e-7;
  EXPECT_THROW(make_localiser("lines", map_of_rooms(10), options), Error);
}

TEST(LineLocaliser, FindsThePoseToMillimetres) {
  const TopologicalMap map = map_of_rooms(10);
  const auto localiser = make_localiser("lines", map);
  for (int i = 0; i < 10; ++i) {
    const Pose2D step{0.2, -0.15, 0.12};
    const LocalisationAnswer answer = localiser->localise(camera_view(full_room(100 + i), step));
    EXPECT_EQ(answer.status, LocalisationStatus::answered) << i;
    EXPECT_EQ(answer.node, i);
    const Pose2D truth = compose(map.nodes[i].pose, step);
    EXPECT_LT(distance_m(answer.pose, truth), 0.01) << i;
    EXPECT_LT(std::abs(heading_difference_rad(answer.pose, truth)), 0.005);
    EXPECT_GT(answer.probability, 0.99);
    ASSERT_FALSE(answer.modes.empty());
    EXPECT_EQ(answer.modes[0].probability, answer.probability);
  }
}

/// A room with each line moved on the floor, by so much in x and y (standard deviation).
std::vector<PlaceLine> refurnished(std::vector<PlaceLine> room, double sd_m, std::uint64_t seed) {
  RandomStream d({.seed = seed});
  for (PlaceLine& line : room) {
    const double x = d.normal(), y = d.normal();
    for (Eigen::Vector3d* end : {&line.a_m, &line.b_m}) *end += sd_m * Eigen::Vector3d(x, y, 0);
  }
  return room;
}

// Rooms of one plan in pairs that differ by 3 cm, the pairs by 5: the ranking does not tell them
// apart, so that half of the true ones are not among its first 16, and the comparison does. Five
// answers were wrong where the search ended with the first that was sure.
TEST(LineLocaliser, RoomsThatRankAlikeAreCompared) {
  constexpr int rooms = 60, first_candidates = 16;
  const std::vector<PlaceLine> plan = full_room(77);
  TopologicalMap map;
  std::vector<std::vector<PlaceLine>> furnished;
  for (int i = 0; i < rooms; ++i) {
    furnished.push_back(refurnished(refurnished(plan, 0.05, 1000 + i / 2), 0.03, 2000 + i));
    map.nodes.push_back({{20.0 * i, 0, 0}, camera_view(furnished.back())});
  }
  const auto ranker = make_ranker("view", map, {});
  const auto localiser = make_localiser("lines", map, {});
  int ranked_low = 0, answered = 0;
  for (int i = 0; i < rooms; ++i) {
    const Pose2D step{0.2, 0.1, 0.1};
    const PlaceView view = camera_view(furnished[i], step);
    const auto ranked = ranker->rank(view, first_candidates);
    ranked_low += std::ranges::none_of(ranked, [&](const auto& one) { return one.node == i; });
    const LocalisationAnswer answer = localiser->localise(view);
    if (answer.status != LocalisationStatus::answered) continue;
    ++answered;
    EXPECT_LT(distance_m(answer.pose, compose(map.nodes[i].pose, step)), 0.05) << i;
  }
  EXPECT_GE(ranked_low, 20);
  EXPECT_GE(answered, 55);
}

TEST(LineLocaliser, AnotherPlaceIsNotAnswered) {
  const TopologicalMap map = map_of_rooms(10);
  const auto localiser = make_localiser("lines", map);
  for (int i = 0; i < 10; ++i) {
    const LocalisationAnswer answer = localiser->localise(camera_view(full_room(500 + i)));
    EXPECT_NE(answer.status, LocalisationStatus::answered) << i;
  }
}

// Every stage left out still gives an answer, a rougher one.
TEST(LineLocaliser, StagesMayBeLeftOut) {
  const TopologicalMap map = map_of_rooms(10);
  const Pose2D step{0.2, -0.15, 0.12};
  const PlaceView query = camera_view(full_room(104), step);
  for (int left_out = 0; left_out < 4; ++left_out) {
    LocaliserOptions options;
    options.max_error_rate = 1;
    bool* stages[] = {&options.stages.deepen, &options.stages.compare, &options.stages.refine,
                      &options.stages.align};
    for (int i = 0; i <= left_out; ++i) *stages[i] = false;
    const LocalisationAnswer answer = make_localiser("lines", map, options)->localise(query);
    EXPECT_EQ(answer.status, LocalisationStatus::answered);
    EXPECT_EQ(answer.node, 4) << left_out;
    EXPECT_LT(distance_m(answer.pose, compose(map.nodes[4].pose, step)), 0.6);
  }
}

TEST(LineLocaliser, StrangeViewsAreNoGuess) {
  const TopologicalMap map = map_of_rooms(10);
  const auto localiser = make_localiser("lines", map);
  EXPECT_EQ(localiser->localise(view_of({})).status, LocalisationStatus::too_few_lines);
  auto one = test::random_room(100, 1);
  EXPECT_EQ(localiser->localise(view_of(one)).status, LocalisationStatus::too_few_lines);
  std::vector<PlaceLine> parallel;
  for (int i = 0; i < 6; ++i) {
    parallel.push_back({{3, 0.2 * i, 0.5}, {3, 0.2 * i, 1.5}, LineKind::vertical, 0.02});
  }
  EXPECT_NE(localiser->localise(view_of(parallel)).status, LocalisationStatus::answered);
  auto spoilt = test::random_room(100, 60);
  for (PlaceLine& line : spoilt) line.a_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(localiser->localise(view_of(spoilt)).status, LocalisationStatus::answered);
  for (PlaceLine& line : spoilt) line.a_m = line.b_m = {1, 1, 1};
  EXPECT_NE(localiser->localise(view_of(spoilt)).status, LocalisationStatus::answered);
  auto millimetres = test::random_room(103, 90);
  for (PlaceLine& line : millimetres) {
    line.a_m *= 1000;
    line.b_m *= 1000;
  }
  EXPECT_NE(localiser->localise(view_of(millimetres)).status, LocalisationStatus::answered);
  const TopologicalMap empty;
  EXPECT_EQ(make_localiser("lines", empty)->localise(view_of(test::random_room(1, 60))).status,
            LocalisationStatus::no_match);
}

/// A localiser of a user's own.
class Constant : public Localiser {
 public:
  LocalisationAnswer localise(const PlaceView&) const override {
    LocalisationAnswer answer;
    answer.status = LocalisationStatus::answered;
    answer.pose = {1, 2, 3};
    return answer;
  }
};

TEST(RegisterLocaliser, MakesItKnown) {
  register_localiser("constant", [](const TopologicalMap&, const LocaliserOptions&) {
    return std::make_unique<Constant>();
  });
  const TopologicalMap map;
  const auto localiser = make_localiser("constant", map);
  const std::vector<Look> looks{{{}, 0.5}, {{}, 1}};
  EXPECT_EQ(localiser->localise_looks(looks).pose.heading_rad, 2.5);
  EXPECT_EQ(test::error_message([] { register_localiser("lines", {}); }),
            "localiser \"lines\": is already registered; choose another name");
  LocaliserOptions none;
  none.candidates = 0;
  EXPECT_EQ(test::error_message([&] { make_localiser("lines", map, none); }),
            "localiser options: candidates or min_lines is out of range; use 1 to 10000 candidates "
            "and at least 1 line");
}

TEST(RegisterLocaliser, WhatMakesNoneIsRefused) {
  EXPECT_EQ(test::error_message([] { register_localiser("made_of_nothing", {}); }),
            "localiser \"made_of_nothing\": has no factory; give a function that makes one");
  register_localiser("a_method_never_made", [](const TopologicalMap&, const LocaliserOptions&) {
    return std::unique_ptr<Localiser>();
  });
  const TopologicalMap map;
  EXPECT_EQ(test::error_message([&] { make_localiser("a_method_never_made", map); }),
            "localiser \"a_method_never_made\": its factory made none; return a localiser or throw "
            "Error");
}

}  // namespace
}  // namespace vernier
