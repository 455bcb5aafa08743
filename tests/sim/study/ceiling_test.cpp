// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/ceiling.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/support/small_office.h"
#include "tests/support/twin_rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

using test::twin_rooms;

TEST(AliasFinder, FindsTheTwinRoom) {
  const World world = twin_rooms(false);
  const Visibility visibility(world);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  const Aliases found = finder.aliases({2, 1, 1.5});
  ASSERT_EQ(found.elsewhere(), 1);
  EXPECT_NEAR(found.poses[1].x_m, 12, 0.03);
  EXPECT_NEAR(found.poses[1].y_m, 1, 0.03);
}

TEST(AliasFinder, OneMoreCupboardTellsThemApart) {
  const World world = twin_rooms(true);
  const Visibility visibility(world);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  EXPECT_EQ(finder.aliases({2, 1, 1.5}).elsewhere(), 0);
}

/// A room of 4 x 5 m, twice, 10 m apart, without anything in it but what `add` gives, at the same
/// place of each.
World twin_rooms_with(const std::function<void(FeatureSet&, double x)>& add) {
  WorldDescription d;
  for (const double x : {0.0, 10.0}) {
    d.loose.surfaces_m.push_back({{x, 0, 0}, {x, 5, 0}, {x, 5, 2.5}, {x, 0, 2.5}});
    d.loose.surfaces_m.push_back({{x + 4, 0, 0}, {x + 4, 5, 0}, {x + 4, 5, 2.5}, {x + 4, 0, 2.5}});
    d.loose.surfaces_m.push_back({{x, 5, 0}, {x + 4, 5, 0}, {x + 4, 5, 2.5}, {x, 5, 2.5}});
    add(d.loose, x);
  }
  d.route.push_back({{{2, 0.5}, {2, 2}}});
  return build_world(d);
}

Aliases aliases_of(const World& world, const Pose2D& pose) {
  const Visibility visibility(world);
  return AliasFinder(visibility, test::nominal_rig().rig, {}).aliases(pose);
}

/// Of poses that look the same, by where a protocol asks in a world.
QueryCeiling ceiling_of(const World& world,
                        QueryProtocol protocol,
                        const std::vector<Pose2D>& alike) {
  const Visibility visibility(world);
  const QueryPlaces places(visibility, protocol, 1.2);
  Aliases asked;
  for (const Pose2D& pose : alike) {
    if (!(places.density(pose) > 0)) continue;
    asked.poses.push_back(pose);
    asked.weights.push_back(places.density(pose));
  }
  return query_ceiling(asked);
}

const Pose2D to_the_far_wall{2, 2, std::numbers::pi / 2};

TEST(AliasFinder, AnUprightAndALevelEdgeSuffice) {
  const World world = twin_rooms_with([](FeatureSet& f, double x) {
    f.segments_m.push_back({{x + 1.6, 5, 0.8}, {x + 1.6, 5, 1.6}});
    f.segments_m.push_back({{x + 1.8, 5, 1.4}, {x + 2.4, 5, 1.4}});
  });
  const Aliases found = aliases_of(world, to_the_far_wall);
  EXPECT_TRUE(found.determined);
  ASSERT_EQ(found.elsewhere(), 1);
  EXPECT_NEAR(found.poses[1].x_m, 12, 1e-6);
  EXPECT_NEAR(found.poses[1].y_m, 2, 1e-6);
}

TEST(AliasFinder, TwoUprightsAtOnePlaceAreAsOne) {
  const auto stack = [](FeatureSet& f, double x) {
    f.segments_m.push_back({{x + 2, 5, 0.7}, {x + 2, 5, 1.1}});
    f.segments_m.push_back({{x + 2, 5, 1.3}, {x + 2, 5, 1.7}});
  };
  const World two = twin_rooms_with(stack);
  const Aliases alone = aliases_of(two, to_the_far_wall);
  EXPECT_FALSE(alone.determined);
  EXPECT_EQ(query_ceiling(alone), (QueryCeiling{0, false}));
  const World with_level = twin_rooms_with([&](FeatureSet& f, double x) {
    stack(f, x);
    f.segments_m.push_back({{x + 1.8, 5, 1.4}, {x + 2.4, 5, 1.4}});
  });
  EXPECT_EQ(aliases_of(with_level, to_the_far_wall).elsewhere(), 1);
}

TEST(AliasFinder, AViewOfNothingOrOfOneLevelEdgeIsNotUnique) {
  const World bare = twin_rooms_with([](FeatureSet&, double) {});
  EXPECT_FALSE(aliases_of(bare, to_the_far_wall).determined);
  const World shelf = twin_rooms_with([](FeatureSet& f, double x) {
    f.segments_m.push_back({{x + 1, 5, 1.2}, {x + 3, 5, 1.2}});
  });
  EXPECT_FALSE(aliases_of(shelf, to_the_far_wall).determined);
}

/// Rooms as above with these legs of a route.
World twin_rooms_with_route(const std::vector<RouteLeg>& route) {
  World world = twin_rooms_with([](FeatureSet&, double) {});
  world.route = route;
  return world;
}

// The other room is no alternative where nothing is asked there, or in the other direction only; it
// is the better guess where the route passes twice as often.
TEST(QueryCeiling, GoesByWhereTheProtocolAsks) {
  const RouteLeg here{{{2, 0.5}, {2, 4}}}, there{{{12, 0.5}, {12, 4}}}, back{{{12, 4}, {12, 0.5}}};
  const double up = std::numbers::pi / 2;
  const std::vector<Pose2D> two{{2, 2, up}, {12, 2, up}};
  const auto of = [&](const std::vector<RouteLeg>& route, QueryProtocol protocol) {
    return ceiling_of(twin_rooms_with_route(route), protocol, two);
  };
  const QueryCeiling one{1, true}, half{0.5, false};
  EXPECT_EQ(of({here}, QueryProtocol::near_path), one);
  EXPECT_EQ(of({here}, QueryProtocol::anywhere), one);
  EXPECT_EQ(of({here, there}, QueryProtocol::near_path), half);
  EXPECT_EQ(of({here, back}, QueryProtocol::path), one);
  EXPECT_EQ(of({here, back}, QueryProtocol::anywhere), half);
  const QueryCeiling twice = of({here, there, there}, QueryProtocol::path);
  EXPECT_DOUBLE_EQ(twice.right, 2.0 / 3);
  EXPECT_FALSE(twice.unaliased);
}

// An answer is right within 1 m: of poses at one place, and of two 1.9 m apart, one guess holds
// all.
TEST(QueryCeiling, OneGuessHoldsAllPosesOfItsDisc) {
  const World world = twin_rooms_with_route({{{{2, 0.5}, {2, 4}}}, {{{12, 0.5}, {12, 4}}}});
  const auto right = [&](const std::vector<Pose2D>& poses) {
    return ceiling_of(world, QueryProtocol::anywhere, poses).right;
  };
  EXPECT_DOUBLE_EQ(right({{2, 1, 1}, {12, 1, 1}, {12, 1, 2}}), 2.0 / 3);
  EXPECT_DOUBLE_EQ(right({{2, 1, 1}, {12, 1, 1}, {12, 2.9, 1}}), 2.0 / 3);
  EXPECT_DOUBLE_EQ(right({{2, 1, 1}, {12, 1, 1}, {12, 3.1, 1}}), 1.0 / 3);
  EXPECT_DOUBLE_EQ(right({{2, 1, 1}, {2, 1.5, 2}}), 1);
}

// A table's edges beside a shelf: they slide along no line.
TEST(AliasFinder, TwoLevelEdgesThatAreNotParallelSuffice) {
  const auto levels = [](bool slanted) {
    return twin_rooms_with([=](FeatureSet& f, double x) {
      f.segments_m.push_back({{x + 1, 5, 1.2}, {x + 3, 5, 1.2}});
      f.segments_m.push_back({{x + 1.5, 4, 0.9}, {x + 2.5, slanted ? 4.6 : 4, 0.9}});
    });
  };
  const Aliases found = aliases_of(levels(true), to_the_far_wall);
  EXPECT_TRUE(found.determined);
  ASSERT_EQ(found.elsewhere(), 1);
  EXPECT_NEAR(found.poses[1].x_m, 12, 1e-6);
  EXPECT_NEAR(found.poses[1].y_m, 2, 1e-6);
  EXPECT_FALSE(aliases_of(levels(false), to_the_far_wall).determined);
}

// The rare edge, of 4 % of the image length, is in one room only: within what may differ.
TEST(AliasFinder, AnEdgeThatMayDifferHidesNoAlias) {
  const World world = twin_rooms_with([](FeatureSet& f, double x) {
    for (const double at : {0.8, 1.4, 2.1, 2.9}) {
      f.segments_m.push_back({{x + at, 5, 0.7}, {x + at, 5, 1.7}});
    }
    if (x == 0) f.segments_m.push_back({{1.8, 5, 1.23}, {1.8, 5, 1.4}});
  });
  EXPECT_EQ(aliases_of(world, to_the_far_wall).elsewhere(), 1);
}

/// A hall of 14.4 x 6 m whose long walls have a board at two of every three places, 0.6 m apart,
/// but for a few that are missing.
World hall_of_boards() {
  WorldDescription d;
  for (const double side : {3.0, -3.0}) {
    d.loose.surfaces_m.push_back(
        {{0, side, 0}, {14.4, side, 0}, {14.4, side, 2.5}, {0, side, 2.5}});
    for (int place = 0; place < 24; ++place) {
      if (place % 3 == 0 || (side > 0 && (place == 10 || place == 17))) continue;
      const double x = 0.6 * place;
      d.loose.segments_m.push_back({{x, side, 0.6}, {x, side, 1.8}});
      d.loose.segments_m.push_back({{x, side, 1.8}, {x + 0.3, side, 1.8}});
    }
  }
  d.route.push_back({{{1, 0}, {13, 0}}});
  return build_world(d);
}

using View = std::vector<VisibleEdge>;

/// Whether one view's edges are those of another but for 5 % of their length, by comparing all with
/// all.
bool explains(const View& there, const View& view, const Camera& camera) {
  const auto on = [](const Eigen::Vector3d& x, const VisibleEdge& e) {
    const Eigen::Vector3d d = e.b_m - e.a_m;
    const double t = std::min(1.0, std::max(0.0, (x - e.a_m).dot(d) / d.squaredNorm()));
    return (e.a_m + t * d - x).norm() < 0.02;
  };
  double all = 0, missing = 0;
  for (const VisibleEdge& e : view) {
    const double length = (project(camera, e.a_m) - project(camera, e.b_m)).norm();
    const auto holds = [&](const VisibleEdge& o) { return on(e.a_m, o) && on(e.b_m, o); };
    all += length;
    if (std::none_of(there.begin(), there.end(), holds)) missing += length;
  }
  return missing <= 0.05 * all;
}

// The hall repeats every 1.8 m and after a half-turn, so that all aliases of these queries are on
// the oracle's grid of 0.05 x 0.25 m and 90 degrees. It shares nothing with the code under test but
// what a camera sees.
TEST(AliasFinder, AgreesWithAllPosesOfAGrid) {
  const World world = hall_of_boards();
  const Visibility visibility(world);
  const Rig& rig = test::nominal_rig().rig;
  std::vector<NoiseFreeView> grid;
  for (int i = 0; i <= 288; ++i) {
    for (int k = -11; k <= 11; ++k) {
      for (int turn = 0; turn < 4; ++turn) {
        grid.push_back(look(visibility, rig, {0.05 * i, 0.25 * k, turn * std::numbers::pi / 2}));
      }
    }
  }
  const AliasFinder finder(visibility, rig, {});
  int aliased = 0, unique = 0;
  for (int query = 0; query < 40; ++query) {
    const Pose2D at{1.2 + 0.3 * query, 0.25 * (query % 5 - 2), query % 4 * std::numbers::pi / 2};
    const View view = look(visibility, rig, at).edges;
    int expected = 0;
    for (const NoiseFreeView& other : grid) {
      expected += distance_m(at, other.pose) > 1 && explains(other.edges, view, rig.cameras[0]) &&
                  explains(view, other.edges, rig.cameras[0]);
    }
    const Aliases found = finder.aliases(at);
    EXPECT_EQ(found.elsewhere(), found.determined ? expected : 0) << "query " << query;
    aliased += expected > 0;
    unique += expected == 0;
  }
  EXPECT_GT(aliased, 5);
  EXPECT_GT(unique, 5);
}

// All of the same height in one room: no pair is rare, and every pair of uprights is too many to
// try (input_growth of bench/ has what it takes).
TEST(AliasFinder, ManyUprightsInOneRoomAreSearched) {
  World world;
  world.objects.resize(1);
  RandomStream draws({.seed = 7});
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Vector3d foot{draws.uniform(0, 20), draws.uniform(0, 20), 0};
    world.segments.push_back({foot, foot + Eigen::Vector3d(0, 0, 2.5), 0});
  }
  const Visibility visibility(world);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  const Aliases found = finder.aliases({10, 10, 0.3});
  EXPECT_TRUE(found.determined);
  EXPECT_EQ(found.elsewhere(), 0);
}

TEST(AliasFinder, TheOfficeIsNotAliasedAlongItsRoute) {
  const AliasFinder finder(test::small_office_visibility(), test::nominal_rig().rig, {});
  double sum = 0;
  const auto places = map_poses(test::small_office().route, 2);
  const QueryPlaces queries(test::small_office_visibility(), QueryProtocol::anywhere, 1.2);
  for (const Pose2D& place : places) sum += query_ceiling(finder.aliases(place, &queries)).right;
  EXPECT_GT(sum / static_cast<double>(places.size()), 0.9);
}

TEST(AliasFinder, AWideWorldTakesNoMoreMemoryThanASmallOne) {
  World world = twin_rooms(true);
  for (const double x : {-1e4, 1e4}) {
    world.segments.push_back({{x, x, 0}, {x, x, 2.5}, 0});
  }
  const Visibility visibility(world);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  getrusage(RUSAGE_SELF, &after);
  EXPECT_EQ(finder.aliases({2, 1, 1.5}).elsewhere(), 0);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 20'000) << "kB";
}

TEST(AliasFinder, StopsAtAThousandAliases) {
  World world = twin_rooms(false);
  const std::size_t segments = world.segments.size(), surfaces = world.surfaces.size();
  for (int i = 1; i < 600; ++i) {
    const Eigen::Vector3d shift(20.0 * i, 0, 0);
    for (std::size_t k = 0; k < segments; ++k) {
      const WorldSegment s = world.segments[k];
      world.segments.push_back({s.a_m + shift, s.b_m + shift, s.object});
    }
    for (std::size_t k = 0; k < surfaces; ++k) {
      WorldSurface surface = world.surfaces[k];
      for (Eigen::Vector3d& p : surface.polygon_m) p += shift;
      world.surfaces.push_back(surface);
    }
  }
  const Visibility visibility(world);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  EXPECT_EQ(finder.aliases({2, 1, 1.5}).elsewhere(), 1000);
  // The protocol asks in the query's room and in the last two, beyond the first 1000.
  world.route = {{{{2, 0.5}, {2, 2}}}};
  for (const double x : {11'972.0, 11'982.0}) {
    world.route.push_back({{{x, 0.5}, {x, 2}}});
  }
  const Visibility asked_in_three(world);
  const QueryPlaces places(asked_in_three, QueryProtocol::path, 1.2);
  const Aliases three = finder.aliases({2, 1, 1.5}, &places);
  EXPECT_EQ(three.elsewhere(), 2);
  EXPECT_DOUBLE_EQ(query_ceiling(three).right, 1.0 / 3);
}

// Boards every 0.4 m along a wall, seen from two legs 5.2 m apart: the aliases between, at which no
// query is, stand for neither.
TEST(AliasFinder, AliasesOfAShortPeriodAreToldApart) {
  WorldDescription d;
  d.loose.surfaces_m.push_back({{-4, 3, 0}, {24, 3, 0}, {24, 3, 2.5}, {-4, 3, 2.5}});
  for (int i = 0; i < 70; ++i) {
    const double x = -4 + 0.4 * i;
    d.loose.segments_m.push_back({{x, 3, 0.6}, {x, 3, 1.8}});
  }
  for (const double x : {8.0, 13.2}) d.route.push_back({{{x, 0}, {x, 0.4}}});
  const World world = build_world(d);
  const Visibility visibility(world);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  const QueryPlaces places(visibility, QueryProtocol::near_path, 1.2);
  for (std::uint32_t trial = 0; trial < 10; ++trial) {
    const Aliases found = finder.aliases(places.draw(3, trial), &places);
    EXPECT_EQ(query_ceiling(found), (QueryCeiling{0.5, false})) << trial;
  }
}

// Level edges of one height in one room, all crossing: pairs are tried up to a million.
TEST(AliasFinder, TooManyLevelEdgesLeaveThePoseOpen) {
  const auto edges = [](int count, double side_m) {
    World world;
    world.objects.resize(1);
    RandomStream draws({.seed = 8});
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d at{draws.uniform(0, side_m), draws.uniform(0, side_m), 1.5};
      const double turn = draws.uniform(0, std::numbers::pi);
      world.segments.push_back({at, at + Eigen::Vector3d(std::cos(turn), std::sin(turn), 0), 0});
    }
    return world;
  };
  EXPECT_TRUE(aliases_of(edges(200, 20), {10, 10, 0.3}).determined);
  EXPECT_FALSE(aliases_of(edges(4000, 10), {5, 5, 0.3}).determined);
}

}  // namespace
}  // namespace vernier
