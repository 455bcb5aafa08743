// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "localise/localiser.h"
#include "localise/odometry/floor_step.h"
#include "localise/odometry/pair_projection.h"
#include "localise/odometry/step_consensus.h"
#include "localise/place.h"
#include "localise/ranking/corner_index.h"
#include "localise/topological_map.h"
#include "tests/support/camera_views.h"
#include "tests/support/error_message.h"

namespace vernier::localise {
namespace {

using vernier::internal::RandomStream;
using vernier::test::error_message;

/// A point of a room, in the world's frame, and what it looks like.
struct Mark {
  Eigen::Vector3d at_m;
  Eigen::VectorXf descriptor;
};

std::vector<Mark> marks(std::uint64_t seed, int count, double x_m = 0) {
  std::vector<Mark> room;
  for (int i = 0; i < count; ++i) {
    RandomStream d({.seed = seed, .feature = static_cast<std::uint32_t>(i)});
    const Eigen::Vector3d at{x_m + d.uniform(2, 8), d.uniform(-3, 3), d.uniform(0, 2.4)};
    room.push_back({at, d.normals(16).cast<float>().normalized()});
  }
  return room;
}

struct Seeing {
  CameraMount mount = {};
  double sigma_px = 0;
  double wrong = 0;  ///< share of corners with a wrong right pixel
  std::uint32_t trial = 0;
};

PlaceView view_of(const std::vector<Mark>& room, const Pose2D& pose, const Seeing& how = {}) {
  PlaceView view;
  view.rig = test::shipped_rig();
  view.mount = how.mount;
  const Pose T_robot_world =
      Pose{rotation_from_vector({0, 0, pose.heading_rad}), Eigen::Vector3d(pose.x_m, pose.y_m, 0)}
          .inverse();
  const Pose T_camera_robot = T_robot_camera(how.mount).inverse();
  for (std::size_t i = 0; i < room.size(); ++i) {
    const auto seen = pixel_pair(*view.rig, T_camera_robot * (T_robot_world * room[i].at_m));
    const auto inside = [](const Eigen::Vector2d& p) {
      return p.x() > 0 && p.x() < 639 && p.y() > 0 && p.y() < 479;
    };
    if (!seen || !inside(seen->first_px) || !inside(seen->other_px)) continue;
    RandomStream d({.seed = 9, .trial = how.trial, .feature = static_cast<std::uint32_t>(i)});
    StereoCorner corner;
    corner.left_px = seen->first_px + how.sigma_px * Eigen::Vector2d(d.normals(2));
    corner.right_px = seen->other_px + how.sigma_px * Eigen::Vector2d(d.normals(2));
    if (d.uniform() < how.wrong) corner.right_px.x() += d.uniform(-10, 10);
    corner.covariance_px2 = std::pow(std::max(how.sigma_px, 0.05), 2) * Eigen::Matrix4d::Identity();
    corner.descriptor = room[i].descriptor;
    view.corners.push_back(std::move(corner));
  }
  return view;
}

/// Nodes half a metre apart that look along x.
TopologicalMap map_of(const std::vector<Mark>& room,
                      int nodes,
                      double x_m = 0,
                      const Seeing& how = {}) {
  TopologicalMap map;
  for (int i = 0; i < nodes; ++i) {
    const Pose2D pose{x_m + 0.5 * i, 0.1 * i, 0.05 * i};
    map.nodes.push_back({pose, view_of(room, pose, how)});
  }
  return map;
}

LocalisationAnswer answer_to(const PlaceView& query,
                             const TopologicalMap& map,
                             const LocaliserOptions& options = {}) {
  return make_localiser("corners", map, options)->localise(query);
}

TEST(CornerLocaliser, WithoutNoiseThePoseIsExact) {
  const auto room = marks(1, 80);
  const TopologicalMap map = map_of(room, 4);
  for (const Pose2D& pose : {Pose2D{0.2, 0.1, 0.1}, Pose2D{1.3, -0.3, -0.2}, Pose2D{0, 0.2, 0}}) {
    const LocalisationAnswer answer = answer_to(view_of(room, pose), map);
    EXPECT_EQ(answer.status, LocalisationStatus::answered);
    EXPECT_LT(distance_m(answer.pose, pose), 1e-6);
    EXPECT_LT(std::abs(heading_difference_rad(answer.pose, pose)), 1e-6);
    EXPECT_LT(distance_m(map.nodes[answer.node].pose, pose), 1.5);
    EXPECT_GT(answer.score, 20);
    EXPECT_EQ(answer.probability, 0);
  }
}

TEST(CornerLocaliser, MapAndQueryMayHaveOtherMounts) {
  const auto room = marks(2, 80);
  const TopologicalMap map = map_of(room, 3, 0, {.mount = {1.0, 0.15}});
  const Pose2D pose{0.4, 0.2, 0.15};
  const LocalisationAnswer answer = answer_to(view_of(room, pose, {.mount = {1.4, -0.1}}), map);
  EXPECT_EQ(answer.status, LocalisationStatus::answered);
  EXPECT_LT(distance_m(answer.pose, pose), 1e-6);
}

TEST(CornerLocaliser, StandsNoiseAndWrongPartners) {
  const auto room = marks(3, 80);
  const TopologicalMap map = map_of(room, 4, 0, {.sigma_px = 0.15, .wrong = 0.2, .trial = 1});
  for (std::uint32_t i = 2; i < 12; ++i) {
    const Pose2D pose{0.1 * i, 0.03 * i, 0.02 * i};
    const LocalisationAnswer answer =
        answer_to(view_of(room, pose, {.sigma_px = 0.15, .wrong = 0.2, .trial = i}), map);
    EXPECT_EQ(answer.status, LocalisationStatus::answered) << i;
    EXPECT_LT(distance_m(answer.pose, pose), 0.1) << i;
    EXPECT_LT(std::abs(heading_difference_rad(answer.pose, pose)), 0.02) << i;
  }
}

/// The same furniture in two rooms: nothing tells them apart but marks of one's own.
TEST(CornerLocaliser, EqualRoomsAreATie) {
  constexpr double apart_m = 30;
  const auto here = marks(4, 60);
  const auto there = marks(4, 60, apart_m);
  TopologicalMap map = map_of(here, 3);
  for (const MapNode& node : map_of(there, 3, apart_m).nodes) map.nodes.push_back(node);
  const Pose2D pose{apart_m + 0.3, 0, 0.1};
  const LocalisationAnswer tie = answer_to(view_of(there, pose), map);
  EXPECT_EQ(tie.status, LocalisationStatus::tie);
  EXPECT_NEAR(tie.runner_up, tie.score, 1e-3);

  auto unlike = there;
  for (const Mark& own : marks(5, 60, apart_m)) unlike.push_back(own);
  map = map_of(here, 3);
  for (const MapNode& node : map_of(unlike, 3, apart_m).nodes) map.nodes.push_back(node);
  const LocalisationAnswer sure = answer_to(view_of(unlike, pose), map);
  EXPECT_EQ(sure.status, LocalisationStatus::answered);
  EXPECT_LT(distance_m(sure.pose, pose), 1e-6);
}

TEST(CornerLocaliser, AnUnknownRoomIsNoMatch) {
  const TopologicalMap map = map_of(marks(6, 80), 3);
  EXPECT_EQ(answer_to(view_of(marks(7, 80), {0.2, 0, 0}), map).status,
            LocalisationStatus::no_match);
}

/// One candidate suffices in a map of many rooms.
TEST(CornerIndex, RanksTheNodeThatSeesTheSameFirst) {
  TopologicalMap map;
  for (std::uint64_t i = 0; i < 20; ++i) {
    for (const MapNode& node : map_of(marks(100 + i, 40), 2).nodes) map.nodes.push_back(node);
  }
  const vernier::localise::internal::CornerIndex index(map);
  EXPECT_EQ(index.descriptor_size(), 16);
  EXPECT_GT(index.words(), 500);
  EXPECT_LE(index.words(), 800);  // a mark that is seen twice is one word
  for (std::uint64_t i = 0; i < 20; ++i) {
    const PlaceView query = view_of(marks(100 + i, 40), {0.1, 0.1, 0.02});
    const auto ranked =
        index.rank(vernier::localise::internal::descriptor_columns(query.corners, 16, "query"), 2);
    ASSERT_EQ(ranked.size(), 2u);
    EXPECT_EQ(ranked[0].node / 2, static_cast<int>(i));
    EXPECT_EQ(ranked[1].node / 2, static_cast<int>(i));
    EXPECT_LE(ranked[0].score, 1 + 1e-6);
  }
}

TEST(CornerLocaliser, SaysWhatItCannotUse) {
  const auto room = marks(8, 60);
  const TopologicalMap map = map_of(room, 2);
  const auto localiser = make_localiser("corners", map);
  PlaceView query;
  EXPECT_EQ(localiser->localise(query).status, LocalisationStatus::too_few_corners);
  query = view_of(room, {});
  query.corners.resize(7);
  EXPECT_EQ(localiser->localise(query).status, LocalisationStatus::too_few_corners);
  EXPECT_EQ(make_localiser("corners", TopologicalMap{})->localise(view_of(room, {})).status,
            LocalisationStatus::no_match);
  TopologicalMap bare = map;
  for (MapNode& node : bare.nodes) node.view.corners.clear();
  EXPECT_EQ(answer_to(view_of(room, {}), bare).status, LocalisationStatus::no_match);

  const auto said_of = [&](const auto& spoil) {
    PlaceView spoilt = view_of(room, {});
    spoil(spoilt);
    TopologicalMap with = map;
    with.nodes[1].view = spoilt;
    const std::string of_map = error_message([&] { make_localiser("corners", with); });
    EXPECT_EQ(of_map.substr(0, 10), "map node 1");
    const std::string of_query = error_message([&] { localiser->localise(spoilt); });
    EXPECT_EQ(of_query.substr(0, 6), "query:");
    return of_query;
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(said_of([](PlaceView& v) { v.corners[3].descriptor.setOnes(8); }), "8 entries"));
  EXPECT_TRUE(has(said_of([](PlaceView& v) {
                    v.corners[3].descriptor[2] = std::numeric_limits<float>::quiet_NaN();
                  }),
                  "not finite"));
  EXPECT_TRUE(has(said_of([](PlaceView& v) { v.corners[3].left_px.x() = nan; }), "not a number"));
  EXPECT_TRUE(has(said_of([](PlaceView& v) { v.corners[3].covariance_px2.setZero(); }),
                  "covariance that is none"));
  EXPECT_TRUE(has(said_of([](PlaceView& v) { v.rig = nullptr; }), "no rig"));
  EXPECT_NE(error_message([&] { make_localiser("corners", map, {.min_corners = 3}); }), "");
}

TEST(NeedsCorners, OfTheMethodAndByOption) {
  EXPECT_TRUE(needs_corners("corners"));
  EXPECT_FALSE(needs_corners("lines"));
  EXPECT_TRUE(needs_corners("lines", {.corners = true}));
  EXPECT_FALSE(needs_corners("no such method"));
  register_localiser("a_method_on_points",
                     [](const TopologicalMap& map, const LocaliserOptions& options) {
                       return make_localiser("corners", map, options);
                     },
                     {.corners = true});
  EXPECT_TRUE(needs_corners("a_method_on_points"));
}

/// The error of a step on the floor is that which its covariance states: the mean NEES of 200
/// trials lies within 4 standard deviations of 3.
TEST(FloorStep, ErrorsAreThoseStated) {
  using namespace vernier::localise::internal;
  constexpr int trials = 200;
  constexpr double sigma_px = 0.2;
  const auto room = marks(11, 60);
  const CameraMount lower{1.0, 0.1}, higher{1.3, -0.05};
  const Pose2D step{0.4, -0.2, 0.15};
  double sum = 0;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    // The same marks are seen in both: those of one list are matched by descriptor.
    const PlaceView a = view_of(room, {}, {.mount = lower, .sigma_px = sigma_px, .trial = trial});
    const PlaceView b =
        view_of(room, step, {.mount = higher, .sigma_px = sigma_px, .trial = trial + trials});
    const FloorViews views{{*a.rig, *b.rig}, lower, higher};
    StepOptions options{.gate_probability = 0.9999};
    const auto links = level_links(views,
                                   triangulated_links(*a.rig, a.corners, b.corners,
                                                      link_corners(a.corners, b.corners), options),
                                   options.gate_probability);
    const auto agreed = floor_consensus(views, links, options);
    ASSERT_TRUE(agreed.has_value());
    const auto found = floor_step(views, links, agreed->T_from_to, options);
    ASSERT_TRUE(found.has_value());
    EXPECT_GT(found->agreeing, 20);
    const Eigen::Vector3d error(found->to_in_from.x_m - step.x_m, found->to_in_from.y_m - step.y_m,
                                heading_difference_rad(found->to_in_from, step));
    sum += error.dot(found->covariance.ldlt().solve(error));
  }
  EXPECT_NEAR(sum / trials, 3, 4 * std::sqrt(2 * 3.0 / trials));
}

TEST(FloorStep, MotionsOfCameraAndRobotBelongTogether) {
  using namespace vernier::localise::internal;
  const auto rig = test::shipped_rig();
  const FloorViews views{{*rig, *rig}, {1.0, 0.2}, {1.5, -0.1}};
  const Pose2D step{0.5, -0.25, 0.75};
  const Pose T = camera_motion(views, step);
  const Pose2D back = robot_step(views, T);
  EXPECT_NEAR(back.x_m, step.x_m, 1e-12);
  EXPECT_NEAR(back.y_m, step.y_m, 1e-12);
  EXPECT_NEAR(back.heading_rad, step.heading_rad, 1e-12);
  const Eigen::Vector3d change(0.1, -0.3, 0.2);
  const Pose2D moved = robot_step(views, retract(T, floor_basis(views) * change));
  EXPECT_NEAR(moved.x_m - step.x_m, change[0], 1e-12);
  EXPECT_NEAR(moved.y_m - step.y_m, change[1], 1e-12);
  EXPECT_NEAR(moved.heading_rad - step.heading_rad, change[2], 1e-12);
}

}  // namespace
}  // namespace vernier::localise
