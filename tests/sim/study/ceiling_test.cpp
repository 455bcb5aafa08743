// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/ceiling.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstddef>

#include "localise/place.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

/// Two closed rooms of 4 x 5 m with the same four cupboards, 10 m apart; the second may get one
/// more.
World twin_rooms(bool tell_apart) {
  WorldDescription d;
  const auto box = [](double x, double y, double z, double sx, double sy, double sz) {
    FeatureSet f;
    const auto corner = [&](int i) {
      return Eigen::Vector3d(x + (i & 1) * sx, y + (i >> 1 & 1) * sy, z + (i >> 2) * sz);
    };
    for (int i = 0; i < 8; ++i) {
      for (const int axis : {1, 2, 4}) {
        if (!(i & axis)) f.segments_m.emplace_back(corner(i), corner(i | axis));
      }
    }
    for (const auto& face :
         {std::array{0, 1, 3, 2}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
          std::array{2, 3, 7, 6}, std::array{0, 2, 6, 4}, std::array{1, 3, 7, 5}}) {
      f.surfaces_m.push_back({corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3])});
    }
    return f;
  };
  d.templates.push_back({"room", box(0, 0, 0, 4, 5, 2.5)});
  d.templates.push_back({"cupboard", box(0, 0, 0, 0.8, 0.4, 1.8)});
  for (const double x : {0.0, 10.0}) {
    d.instances.push_back({"room", {x, 0, 0}, 0});
    d.instances.push_back({"cupboard", {x + 0.3, 4.5, 0}, 0});
    d.instances.push_back({"cupboard", {x + 2.1, 4.4, 0}, 0});
    d.instances.push_back({"cupboard", {x + 3.5, 3.1, 0}, 0});
  }
  if (tell_apart) d.instances.push_back({"cupboard", {11.4, 3.7, 0}, 0.4});
  d.route.push_back({{{2, 0.5}, {2, 2}}});
  return build_world(d);
}

TEST(AliasFinder, FindsTheTwinRoom) {
  const World world = twin_rooms(false);
  const Visibility visibility(world);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  const Aliases found = finder.aliases({2, 1, 1.5});
  ASSERT_EQ(found.elsewhere, 1);
  EXPECT_NEAR(found.examples[0].x_m, 12, 0.03);
  EXPECT_NEAR(found.examples[0].y_m, 1, 0.03);
  EXPECT_NEAR(found.ceiling(), 0.5, 1e-12);
}

TEST(AliasFinder, OneMoreCupboardTellsThemApart) {
  const World world = twin_rooms(true);
  const Visibility visibility(world);
  const AliasFinder finder(visibility, test::nominal_rig().rig, {});
  EXPECT_EQ(finder.aliases({2, 1, 1.5}).elsewhere, 0);
}

TEST(AliasFinder, TheOfficeIsNotAliasedAlongItsRoute) {
  const AliasFinder finder(test::small_office_visibility(), test::nominal_rig().rig, {});
  double sum = 0;
  const auto places = map_poses(test::small_office().route, 2);
  for (const Pose2D& place : places) sum += finder.aliases(place).ceiling();
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
  EXPECT_EQ(finder.aliases({2, 1, 1.5}).elsewhere, 0);
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
  EXPECT_EQ(finder.aliases({2, 1, 1.5}).elsewhere, 1000);
}

}  // namespace
}  // namespace vernier
